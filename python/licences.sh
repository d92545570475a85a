#!/bin/sh
# licences.sh [CRATE FOLDER FEATURES...]: the licence texts of every crate that CRATE links, in FOLDER/THIRD-PARTY, each text once. Without
# arguments for the Python module, on every platform that wheels are made for: python/licenses is committed, so that wheels and source
# packages of a plain clone have it, and `make python` compares it.
set -eu
cd "$(dirname "$0")"
crate=${1:-stickslip-python} folder=${2:-licenses}
if [ $# -gt 2 ]; then
	shift 2
	set -- --filter-platform x86_64-unknown-linux-gnu "$@"
else
	set -- --no-default-features
	for platform in x86_64-unknown-linux-gnu aarch64-unknown-linux-gnu x86_64-unknown-linux-musl aarch64-unknown-linux-musl \
		x86_64-apple-darwin aarch64-apple-darwin x86_64-pc-windows-msvc; do
		set -- "$@" --filter-platform "$platform"
	done
fi
mkdir -p "$folder"
cargo metadata --locked --format-version 1 "$@" --manifest-path ../Cargo.toml |
	CRATE=$crate FOLDER=$folder python3 -c '
import json, os, pathlib, sys

data = json.load(sys.stdin)
nodes = {node["id"]: node for node in data["resolve"]["nodes"]}
todo, seen = [p["id"] for p in data["packages"] if p["name"] == os.environ["CRATE"]], set()
while todo:
    one = todo.pop()
    if one not in seen:
        seen.add(one)
        normal = [d["pkg"] for d in nodes[one]["deps"] if any(k["kind"] is None for k in d["dep_kinds"])]
        todo += normal
linked, texts, missing = [], {}, []
for package in sorted(data["packages"], key=lambda p: (p["name"], p["version"])):
    if package["id"] not in seen or package["source"] is None:
        continue
    folder = pathlib.Path(package["manifest_path"]).parent
    files = [f for f in sorted(folder.iterdir()) if f.is_file() and f.name.upper().startswith(("LICENSE", "LICENCE", "COPYING", "NOTICE", "UNLICENSE"))]
    name = "%s %s" % (package["name"], package["version"])
    linked.append("%s: %s\n" % (name, package["license"]))
    for file in files:
        text = "\n".join(line.rstrip() for line in file.read_text(errors="replace").strip().splitlines()) + "\n"
        # Texts that differ in their line breaks are one text.
        texts.setdefault(" ".join(text.split()), (text, []))[1].append("%s, %s" % (name, file.name))
    missing += [] if files else ["%s (%s)" % (name, package["license"])]
out = ["Crates that are linked, and their licences:\n\n" + "".join(linked)]
out += ["=" * 100 + "\n" + "\n".join(names) + "\n" + "-" * 100 + "\n" + text for text, names in texts.values()]
(pathlib.Path(os.environ["FOLDER"]) / "THIRD-PARTY").write_text("\n".join(out))
if missing:
    print("without a text of their own:", ", ".join(missing), file=sys.stderr)
'
