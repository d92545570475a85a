"""The lap joint of lap-joint.toml: slip limit, hysteresis loop, work of friction. Run from the root of the repository."""

from pathlib import Path

import matplotlib

matplotlib.use("svg")
import matplotlib.pyplot as plt
import numpy as np
import stickslip as ss

out = Path("results/lap-joint-python")
out.mkdir(parents=True, exist_ok=True)

# Run; check() raises an exception if a law is violated.
result = ss.run("data/tutorials/lap-joint.toml").check()
print(result)

# The grip on the right is the second support. Reports are in the units of the scene, mm and N/mm.
time = result.t
pull = np.array([row["supports"][1]["force"][0] for row in result.report["reactions"]])
path = 0.06 * np.interp(time, [1, 2, 3, 4, 5, 6], [0, 1, 0, -1, 0, 1])
print(f"slips at {pull.max():.2f} N/mm when pulled, {-pull.min():.2f} N/mm when pushed")

# The work of a cycle, 2 s to 6 s: the area of the loop, and what friction dissipates. mJ/mm.
cycle = time > 1.999
area = np.sum(np.diff(path[cycle]) * (pull[cycle][1:] + pull[cycle][:-1]) / 2)
friction = sum(record["friction_work"] for record in result.records if record["time"] > 2.001)
print(f"work of a cycle: {area:.2f} mJ/mm by the loop, {friction:.2f} mJ/mm by friction")

# Arrays of the contact nodes are in SI units.
k = np.flatnonzero(np.isclose(time, 1.5))[0]
print(f"at 1.5 s {np.sum(result.contact[k] == ss.SLIP)} nodes slip, {np.sum(result.contact[k] == ss.STICK)} stick")

fig, ax = plt.subplots(figsize=(6, 4), layout="constrained")
ax.plot(path, pull, ".-")
ax.set(xlabel="displacement of the grip, mm", ylabel="pull, N/mm", title="Lap joint")
ax.grid(alpha=0.3)
fig.savefig(out / "loop.svg")

# A stronger bolt: the pressure under the washers of 16 mm, in both loads.
for pressure in (60, 70, 80):
    forces = ss.run("data/tutorials/lap-joint.toml", {"load.pressure": pressure}).check().report["forces"]
    limit = max(row["sum_p_t"] for row in forces)
    print(f"bolt {pressure * 16 * 40 / 1000:.1f} kN: slips at {limit * 40 / 1000:.2f} kN")
