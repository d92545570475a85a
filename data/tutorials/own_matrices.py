"""Three blocks on a floor, joined by springs and pulled: a problem of matrices alone."""

from pathlib import Path

import matplotlib

matplotlib.use("svg")
import matplotlib.pyplot as plt
import numpy as np
import stickslip as ss

k, press, mu = 1e5, 100.0, 0.3          # N/m, N on each block, friction

# Unknowns: x of the blocks 1, 2, 3, then y. Springs: wall - 1 - 2 - 3; each y has a spring of its own.
K = np.zeros((6, 6))
K[:3, :3] = k * np.array([[2, -1, 0], [-1, 2, -1], [0, -1, 1]])
K[3:, 3:] = 1e6 * np.eye(3)
C_n = np.hstack([np.zeros((3, 3)), -np.eye(3)])     # towards the floor: -y
C_t = np.hstack([np.eye(3), np.zeros((3, 3))])      # along it: x
problem = ss.ContactProblem(K, C_n, C_t, mu=mu)

# Loads: the press on each block, the pull on the last. Factors: a row for each increment.
loads = np.array([[0, 0, 0, -press, -press, -press], [0, 0, 1, 0, 0, 0]])
pulls = np.array([0, 15, 30, 45, 60, 75, 60, 30, 15, 0])
factors = np.column_stack([np.ones(len(pulls)), pulls])
result = problem.solve(loads, factors).check()

names = {ss.OPEN: "open", ss.STICK: "stick", ss.SLIP: "slip"}
print("pull, N   x1, mm   x2, mm   x3, mm   wall, N   statuses")
for F, u, statuses in zip(pulls, result.u, result.contact):
    print(f"{F:7.0f} {1e3 * u[0]:8.3f} {1e3 * u[1]:8.3f} {1e3 * u[2]:8.3f} {k * u[0]:9.3f}   {[names[s] for s in statuses]}")

# The judge: any answer, here one that is wrong by 1 N of friction.
last = 5
force, before = factors[last] @ loads, problem.slip(result.u[last - 1])
for error in (0.0, 1.0):
    friction = result.p_t[last] + error
    judged = ss.measure(problem, force, result.u[last], result.p_n[last], friction, w_t_last=before)
    print(f"friction off by {error:.0f} N: largest error {judged.error:.0e} ({judged.law})")

out = Path("results/own-matrices")
out.mkdir(parents=True, exist_ok=True)
fig, ax = plt.subplots(figsize=(6, 3.5), layout="constrained")
for block in range(3):
    ax.plot(1e3 * result.u[:, block], pulls, ".-", label=f"block {block + 1}")
ax.set(xlabel="displacement, mm", ylabel="pull, N", title="Chain of blocks")
ax.legend()
fig.savefig(out / "chain.svg")
