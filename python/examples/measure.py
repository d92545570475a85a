"""What the module costs: beside the program, callbacks, memory, imports. Prints what doc/howto/python.md has.

python measure.py [PROGRAM]     the program of the same cargo profile
"""

import json
import resource
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import stickslip as ss

BLOCK = str(Path(__file__).parents[2] / "data" / "scenes" / "block.toml")
KEYS = {"solver.setting": "default"}


def least(run: Callable[[], object], times: int = 7) -> float:
    """The least CPU time of several, s."""
    found = []
    for _ in range(times):
        start = time.process_time()
        run()
        found.append(time.process_time() - start)
    return min(found)


def program(path: str) -> float:
    """CPU time of the whole process, s."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    words = [f"--set={key}={json.dumps(value)}" for key, value in KEYS.items()]
    subprocess.run([path, "run", BLOCK, "--json", "--solver", "condensed-faer", "--threads", "1", *words], capture_output=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


if len(sys.argv) > 1:
    print(f"program:        {min(program(sys.argv[1]) for _ in range(7)):.3f} s")
print(f"module:         {least(lambda: ss.run(BLOCK, KEYS, linear='condensed')):.3f} s")
print(f"with callbacks: {least(lambda: ss.run(BLOCK, KEYS, linear='condensed', callback=lambda *_: None)):.3f} s")

small = {"mesh.elements": [10, 10], "solver.setting": "default", "output.times": []}
for increments in (1000, 10_000):
    ss.run(BLOCK, {**small, "time.increments": increments}, keep_u="none")
    print(f"{increments} increments, keep_u='none': at most {resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024:.0f} MB")

start = "import time; t = time.process_time(); import numpy, scipy.sparse; n = time.process_time(); import stickslip; "
words = subprocess.run([sys.executable, "-c", start + "print(n - t, time.process_time() - n)"], capture_output=True, text=True)
numpy, own = map(float, words.stdout.split())
print(f"import: numpy and scipy.sparse {numpy:.3f} s, stickslip {own:.3f} s")
