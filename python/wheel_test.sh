#!/bin/bash
# A wheel in fresh environments: installed by one command, a scene run and drawn; and what must be in the file, or must not.
#   python/wheel_test.sh WHEEL PYTHON...
set -euo pipefail
wheel=$1
shift
root=$(cd "$(dirname "$0")/.." && pwd)
scene=$root/data/scenes/block.toml
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

case $wheel in *-abi3-manylinux*) ;; *) echo "$wheel: not for any Python on any Linux" && exit 1 ;; esac
python3 -m zipfile -e "$wheel" "$scratch/wheel"
for text in LICENSE-MIT LICENSE-APACHE THIRD-PARTY; do
	ls "$scratch"/wheel/stickslip-*.dist-info/licenses/licenses/$text >/dev/null
done
ls "$scratch/wheel/stickslip/py.typed" "$scratch/wheel/stickslip/_core.pyi" >/dev/null
# Of the machine that built it nothing is told.
if grep -raohE "($root|$HOME|/home|/root|/Users)/[[:alnum:]._/-]+" "$scratch/wheel/stickslip" | sort -u | head | grep .; then
	echo "paths of the building machine"
	exit 1
fi

tried=0
for python in "$@"; do
	command -v "$python" >/dev/null || { echo "$python: not here"; continue; }
	"$python" -m venv "$scratch/$(basename "$python")-$tried"
	own=$scratch/$(basename "$python")-$tried/bin/python
	"$own" -m pip install -q "$wheel[plot]"
	(cd "$scratch" && MPLBACKEND=agg "$own" -W error -c '
import sys
import stickslip as ss
result = ss.run(sys.argv[1], {"mesh.elements": [20, 20]}).check()
result.plot().figure.savefig("block.png")
print(sys.version.split()[0], result)
' "$scene")
	[ -s "$scratch/block.png" ]
	rm "$scratch/block.png"
	tried=$((tried + 1))
done
[ "$tried" -gt 0 ]
echo "$tried Pythons, $(stat -c %s "$wheel") bytes"
