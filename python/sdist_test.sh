#!/bin/bash
# A source package in a fresh environment: what must be in it, and compiled and installed by pip alone.
#   python/sdist_test.sh SDIST PYTHON
set -euo pipefail
sdist=$(realpath "$1") python=$2
scene=$(cd "$(dirname "$0")/.." && pwd)/data/scenes/block.toml
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

tar -tzf "$sdist" >"$scratch/names"
for text in LICENSE-MIT LICENSE-APACHE THIRD-PARTY Cargo.lock py.typed README.md; do
	grep -q "/$text\$" "$scratch/names" || { echo "$sdist: no $text" && exit 1; }
done
if grep -E '/(python/tests|python/docs|python/examples|fuzz|studies)/' "$scratch/names"; then
	echo "$sdist: what nobody builds from"
	exit 1
fi
"$python" -m venv "$scratch/environment"
# The files of a source package are older than anything compiled, so that Cargo would take what another one has left.
unset CARGO_BUILD_TARGET
export CARGO_TARGET_DIR=$scratch/target
"$scratch/environment/bin/pip" install -q --no-cache-dir "$sdist"
cd "$scratch"
environment/bin/python -c '
import importlib.metadata, sys, warnings
import stickslip as ss
texts = [file.name for file in importlib.metadata.files("stickslip") if "licenses" in file.parts]
warnings.simplefilter("ignore", ss.AccuracyWarning)
assert {"LICENSE-MIT", "LICENSE-APACHE", "THIRD-PARTY"} <= set(texts), texts
print(ss.__version__, ss.run(sys.argv[1], {"mesh.elements": [20, 20]}).check())
' "$scene"
environment/bin/stickslip --version
echo "$(stat -c %s "$sdist") bytes, $(wc -l <"$scratch/names") files"
