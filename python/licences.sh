#!/bin/sh
# The licence texts of every crate that is linked, for a wheel that is passed on; ours go into every wheel.
set -eu
cd "$(dirname "$0")"
mkdir -p licenses
cargo metadata --format-version 1 --filter-platform x86_64-unknown-linux-gnu --no-default-features --manifest-path Cargo.toml |
	python3 -c '
import json, pathlib, sys

data = json.load(sys.stdin)
nodes = {node["id"]: node for node in data["resolve"]["nodes"]}
todo, seen = [p["id"] for p in data["packages"] if p["name"] == "stickslip-python"], set()
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
pathlib.Path("licenses/THIRD-PARTY").write_text("\n".join(out))
if missing:
    print("without a text of their own:", ", ".join(missing), file=sys.stderr)
'
