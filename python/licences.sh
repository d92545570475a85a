#!/bin/sh
# licences.sh [CRATE FOLDER FEATURES...]: the licence texts of every crate that CRATE links, in FOLDER/THIRD-PARTY. Without arguments for
# a wheel that is passed on. Ours go into every wheel.
set -eu
cd "$(dirname "$0")"
crate=${1:-stickslip-python} folder=${2:-licenses}
if [ $# -gt 2 ]; then shift 2; else set -- --no-default-features; fi
mkdir -p "$folder"
cargo metadata --format-version 1 --filter-platform x86_64-unknown-linux-gnu "$@" --manifest-path ../Cargo.toml |
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
out, missing = [], []
for package in sorted(data["packages"], key=lambda p: (p["name"], p["version"])):
    if package["id"] not in seen or package["source"] is None:
        continue
    folder = pathlib.Path(package["manifest_path"]).parent
    texts = [f for f in sorted(folder.iterdir()) if f.is_file() and f.name.upper().startswith(("LICENSE", "LICENCE", "COPYING", "NOTICE", "UNLICENSE"))]
    name = package["name"], package["version"], package["license"]
    out.append("=" * 100 + "\n%s %s: %s\n" % name)
    out += [f.read_text(errors="replace") for f in texts]
    missing += [] if texts else ["%s %s (%s)" % name]
(pathlib.Path(os.environ["FOLDER"]) / "THIRD-PARTY").write_text("\n".join(out))
if missing:
    print("without a text of their own:", ", ".join(missing), file=sys.stderr)
'
