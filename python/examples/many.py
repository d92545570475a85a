"""Random friction fields on one body: the cost of a sample, side by side, condensed, one by one and each as a problem of its own.

    python many.py [elements] [samples]
"""

import sys
import time
from collections.abc import Callable, Sequence

import numpy as np

import stickslip as ss


def timed(name: str, samples: int, work: Callable[[], Sequence[ss.Result]]) -> Sequence[ss.Result]:
    wall, cpu = time.perf_counter(), time.process_time()
    results = work()
    wall, cpu = time.perf_counter() - wall, time.process_time() - cpu
    print(f"{name:36} {1e3 * cpu / samples:7.1f} ms of CPU a sample, {1e3 * wall / samples:7.1f} ms by the clock, {samples} samples")
    return results


def main(n: int = 80, samples: int = 200) -> None:
    block = ss.Scene.block([1.0, 1.0], [n, n]).material(young=210e9, poisson=0.3, plane="strain").support("left", "x", "y")
    block = block.contact("bottom", ss.builder.plane(gap=1e-5), friction=0.4).time(end=2.0, increments=40)
    block = block.load("top", traction=[0.0, -10e6], history=[[0, 0], [1, 1]])
    block = block.load("right", traction=[-10e6, 0.0], history=[[0, 0], [1, 1], [2, 0]])
    model = ss.Model(block)
    problem, force = model.problem, model.history["force"]

    # Fields of a few waves, with a standard deviation of about 0.1.
    waves = np.sin(np.pi * np.outer(np.arange(1, 6), model.contact_points[:, 0]))
    mus = np.clip(0.4 + np.random.default_rng(0).normal(scale=0.1, size=(samples, 5)) @ waves, 0.05, 1.0)

    many = timed("solve_many", samples, lambda: problem.solve_many(force, gap=1e-5, mus=mus, keep_u="none").check())

    # The judge looks at the contact alone then; `small.lift` gives the displacements of the body where they are wanted.
    small = problem.condense()
    reduced = small.reduce(force)
    condensed = timed(
        "solve_many of the condensed problem", samples, lambda: small.solve_many(reduced, gap=1e-5, mus=mus, keep_u="none").check()
    )

    few = mus[: max(1, samples // 10)]
    each = timed("solve(mu=...)", len(few), lambda: [problem.solve(force, gap=1e-5, mu=mu, keep_u="none").check() for mu in few])
    K, C_n, C_t = problem.K, problem.C_n, problem.C_t
    anew = timed(
        "a ContactProblem for each", len(few),
        lambda: [ss.ContactProblem(K, C_n, C_t, mu).solve(force, gap=1e-5, keep_u="none").check() for mu in few],
    )

    scale = max(result.p_n.max() for result in many)
    worst = max(abs(a.p_t - b.p_t).max() for others in (condensed, each, anew) for a, b in zip(many, others)) / scale
    print(f"the answers are the same to {worst:.1e} of the largest force")
    held = abs(np.array([result.p_t[-1].sum() for result in many]))
    print(f"friction at the end: {held.mean():.4e} N/m, standard deviation {held.std():.1e}")


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
