"""200 random friction fields on one body: the cost of a sample, side by side, condensed, one by one and each as a problem of its own.

    python many.py [elements] [samples]
"""

import sys
import time

import numpy as np

import stickslip as ss


def main(n: int = 80, samples: int = 200) -> None:
    block = ss.Scene.block([1.0, 1.0], [n, n]).material(young=210e9, poisson=0.3, plane="strain").support("left", "x", "y")
    block = block.contact("bottom", ss.builder.plane(gap=1e-5), friction=0.4).time(end=2.0, increments=40)
    block = block.load("top", traction=[0.0, -10e6], history=[[0, 0], [1, 1]])
    block = block.load("right", traction=[-10e6, 0.0], history=[[0, 0], [1, 1], [2, 0]])

    start = time.perf_counter()
    model = ss.Model(block)
    problem, force = model.problem, model.history["force"]
    x = model.contact_points[:, 0]
    # A field of a few waves, of a standard deviation of 0.1.
    amplitudes = np.random.default_rng(0).normal(scale=0.1, size=(samples, 5))
    mus = np.clip(0.4 + amplitudes @ np.sin(np.pi * np.outer(np.arange(1, 6), x)), 0.05, 1.0)
    print(f"model, {n} x {n} elements: {1e3 * (time.perf_counter() - start):.0f} ms")

    start = time.perf_counter()
    many = problem.solve_many(force, gap=1e-5, mus=mus, keep_u="none").check()
    print(f"solve_many, {samples} samples: {1e3 * (time.perf_counter() - start) / samples:.1f} ms each")

    # The judge looks at the contact alone then; `small.lift` gives the displacements of the body where they are wanted.
    start = time.perf_counter()
    small = problem.condense()
    condensed = small.solve_many(small.reduce(force), gap=1e-5, mus=mus, keep_u="none").check()
    print(f"solve_many of the condensed problem: {1e3 * (time.perf_counter() - start) / samples:.1f} ms each")

    few = mus[: max(1, samples // 10)]
    start = time.perf_counter()
    one_by_one = [problem.solve(force, gap=1e-5, mu=mu, keep_u="none").check() for mu in few]
    print(f"solve(mu=...): {1e3 * (time.perf_counter() - start) / len(few):.1f} ms each")

    start = time.perf_counter()
    K, C_n, C_t = problem.K, problem.C_n, problem.C_t
    anew = [ss.ContactProblem(K, C_n, C_t, mu).solve(force, gap=1e-5, keep_u="none").check() for mu in few]
    print(f"a ContactProblem for each: {1e3 * (time.perf_counter() - start) / len(few):.1f} ms each")

    scale = many.stack("p_n").max()
    worst = max(abs(a.p_t - b.p_t).max() for others in (condensed, one_by_one, anew) for a, b in zip(many, others)) / scale
    print(f"the answers are the same to {worst:.1e} of the largest force")
    held = abs(many.stack("p_t")[:, -1, :, 0].sum(axis=1))
    print(f"friction at the end: {held.mean():.4e} N/m, standard deviation {held.std():.1e}")


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
