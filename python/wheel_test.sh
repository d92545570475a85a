#!/bin/bash
# A wheel in fresh environments: installed by one command, a scene run and drawn, and the program run; and what must be in the file, or must not.
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
for text in LICENSE-MIT LICENSE-APACHE licenses/THIRD-PARTY; do
	ls "$scratch"/wheel/stickslip-*.dist-info/licenses/$text >/dev/null
done
ls "$scratch/wheel/stickslip/py.typed" "$scratch/wheel/stickslip/_core.pyi" >/dev/null
# Of the machine that built it nothing is told.
if grep -raohE "($root|$HOME|/home|/root|/Users)/[[:alnum:]._/-]+" "$scratch/wheel/stickslip" | sort -u | head | grep .; then
	echo "paths of the building machine"
	exit 1
fi

tried=0
environment() { # environment PYTHON WHAT-TO-INSTALL...
	own=$scratch/environment-$tried/bin
	tried=$((tried + 1))
	"$1" -m venv "${own%/bin}"
	"$own/pip" install -q "${@:2}"
	(cd "$scratch" && MPLBACKEND=agg "$own/python" -W error -W ignore::DeprecationWarning:matplotlib -c '
import sys
import warnings
import numpy, scipy
import stickslip as ss
warnings.simplefilter("ignore", ss.AccuracyWarning)
result = ss.run(sys.argv[1], {"mesh.elements": [20, 20]}).check()
result.plot().figure.savefig("block.png")
print(sys.version.split()[0], "numpy", numpy.__version__, "scipy", scipy.__version__, result)
' "$scene")
	[ -s "$scratch/block.png" ]
	rm "$scratch/block.png"
	# The command: a folder with its page.
	"$own/stickslip" run "$scene" --solver auto --set 'mesh.elements=[20,20]' --out "$scratch/block" --quiet
	[ -s "$scratch/block/report.html" ]
	rm -r "$scratch/block"
}
oldest=
for python in "$@"; do
	"$python" -c '' 2>/dev/null || { echo "$python: not here"; continue; }
	environment "$python" "$wheel[plot]"
	# The oldest numpy and scipy that are promised are no longer made for new Pythons.
	"$python" -c 'import sys; sys.exit(sys.version_info >= (3, 12))' && oldest=${oldest:-$python}
done
if [ -n "$oldest" ]; then
	environment "$oldest" "$wheel[plot]" numpy==1.24.* scipy==1.10.* pytest hypothesis meshio
	"$own/pytest" -q "$root/python/tests"
fi
[ "$tried" -gt 0 ]
echo "$tried environments, $(stat -c %s "$wheel") bytes"
