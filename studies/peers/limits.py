#!/usr/bin/env python3
"""How fast direct solvers factor the matrices of a scene, and how far that is from the machine.

    python3 studies/peers/limits.py data/scenes/block.toml 100 200
    python3 studies/peers/limits.py data/scenes/cube.toml 16

needs the Python module. For K with all contact displacements free, and for the whole system with all contact nodes stuck: the numeric
phase and a solve of one right-hand side, CPU seconds of one thread, the least of five; entries of the factors; beside dgemm and the speed of
reading memory. A solver that is not installed is left out with a line:

    PARDISO    pip install pypardiso
    MUMPS      pip install --no-deps python-mumps, built on Debian's libmumps-seq-dev
    CHOLMOD    pip install --no-deps 'scikit-sparse<0.5', built on Debian's libsuitesparse-dev
    UMFPACK    Debian's libumfpack5, called by ctypes

MUMPS and UMFPACK get the order, of those they have, with the fewest entries. `cargo bench -p stickslip-studies --bench factor` and `--bench
cholesky` have the figures of the program's own factorisations of the same bodies.
"""

import ctypes
import os
import sys
import time
from ctypes.util import find_library

os.environ |= {name: "1" for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")}

import numpy as np
import scipy.sparse as sp


def best(work, rounds=5):
    """The least CPU seconds of a call."""
    seconds = []
    for _ in range(rounds):
        start = time.process_time()
        work()
        seconds.append(time.process_time() - start)
    return min(seconds)


# Each solver takes a matrix, of which kind it is ("definite", "symmetric" or "unsymmetric"), and a right-hand side. It returns entries, Gflop,
# seconds of the numeric phase, seconds of a solve, and the solution; None where it has no factorisation of that kind.


def pardiso(A, kind, b):
    from pypardiso import PyPardisoSolver

    solver = PyPardisoSolver(mtype={"definite": 2, "symmetric": -2, "unsymmetric": 11}[kind])
    # Asks for the entries of the factors, and for Mflop of the factorisation.
    solver.set_iparm(18, -1)
    solver.set_iparm(19, -1)
    # PARDISO wants the whole diagonal in the pattern.
    A = (A + sp.diags(np.where(A.diagonal() == 0, 1e-300, 0))).tocsr()
    A = sp.csr_matrix(A if kind == "unsymmetric" else sp.triu(A))
    A.sort_indices()
    call = lambda phase: (solver.set_phase(phase), solver._call_pardiso(A, b[:, None]))[1]
    call(11)
    entries, gflop = int(solver.iparm[17]), 1e-3 * int(solver.iparm[18])
    return entries, gflop, best(lambda: call(22)), best(lambda: call(33)), call(33).ravel()


def mumps(A, kind, b):
    import mumps
    from mumps import _mumps

    def analysed(ordering):
        context = mumps.Context()
        context.mumps_instance, context.dtype = _mumps.dmumps(False, {"definite": 1, "symmetric": 2, "unsymmetric": 0}[kind]), "d"
        context.set_matrix(A, symmetric=kind != "unsymmetric")
        context.analyze(ordering=ordering)
        return context

    orders = [order for order in mumps.possible_orderings() if order != "auto"]
    context = min(map(analysed, orders), key=lambda context: context.analysis_stats.est_nonzeros)
    factor = best(lambda: context.factor(reuse_analysis=True))
    stats = context.factor_stats
    return stats.nonzeros, 1e-9 * stats.flops, factor, best(lambda: context.solve(b)), context.solve(b)


def cholmod(A, kind, b):
    if kind != "definite":
        return None
    from sksparse.cholmod import analyze

    A = sp.csc_matrix(A)
    factor = analyze(A)
    seconds = best(lambda: factor.cholesky_inplace(A))
    counts = np.diff(factor.copy().L().indptr)
    return counts.sum(), 1e-9 * (counts.astype(float) ** 2).sum(), seconds, best(lambda: factor.solve_A(b)), factor.solve_A(b)


def umfpack(A, kind, b):
    if kind != "unsymmetric":
        return None
    name = find_library("umfpack")
    if name is None:
        raise ImportError("no libumfpack")
    library, A = ctypes.CDLL(name), sp.csc_matrix(A)
    A.sort_indices()
    of = lambda array: array.ctypes.data_as(ctypes.c_void_p)
    n, p, i, x = len(b), of(A.indptr), of(A.indices), of(A.data)
    control, info, solution = np.zeros(20), np.zeros(90), np.zeros(n)
    symbolic, numeric = ctypes.c_void_p(), ctypes.c_void_p()
    library.umfpack_di_defaults(of(control))

    def factor():
        library.umfpack_di_free_numeric(ctypes.byref(numeric))
        assert library.umfpack_di_numeric(p, i, x, symbolic, ctypes.byref(numeric), of(control), of(info)) == 0

    def analyse(order):
        control[10] = order
        library.umfpack_di_free_symbolic(ctypes.byref(symbolic))
        assert library.umfpack_di_symbolic(n, n, p, i, x, ctypes.byref(symbolic), of(control), of(info)) == 0
        factor()
        return info[43] + info[44]

    # AMD or COLAMD, and METIS.
    analyse(min((1, 3), key=analyse))
    seconds = best(factor)
    # Without refinement, as the others.
    control[7] = 0
    solve = lambda: library.umfpack_di_solve(0, p, i, x, of(solution), of(b), numeric, of(control), of(info))
    return info[43] + info[44], 1e-9 * info[42], seconds, best(solve), solution


def main(scene, *sizes):
    import stickslip as ss

    a, x = np.ones((1500, 1500)), np.ones(2**23)
    print(f"dgemm {2 * 1500**3 * 1e-9 / best(lambda: a @ a):.1f} Gflop/s; reading memory {8e-9 * len(x) / best(lambda: x.sum()):.1f} GB/s; "
          f"load average {os.getloadavg()[0]:.1f}\n")
    print("| matrix | solver | unknowns | entries | Gflop | factor s | Gflop/s | solve s | GB/s | backward error |\n" + "| --- " * 10 + "|")
    for size in sizes:
        problem = ss.Model(scene, {"mesh.elements": [int(size)] * (3 if "cube" in scene else 2)}).problem
        # In units in which the largest entry of K is 1.
        K = sp.csr_matrix(problem.K) / problem.K.max()
        B = sp.vstack([problem.C_n, *problem.C_t])
        whole = sp.csr_matrix(sp.bmat([[K, B.T], [B, None]]))
        for name, A, kind in (("K", K, "definite"), ("whole", whole, "symmetric"), ("whole", whole, "unsymmetric")):
            b = np.ones(A.shape[0])
            for solver in (pardiso, mumps, cholmod, umfpack):
                head = f"| {size}, {name}, {kind} | {solver.__name__.upper()} |"
                try:
                    found = solver(A, kind, b)
                except ImportError as missing:
                    print(f"{head} left out: {missing} |" + " |" * 7, flush=True)
                    continue
                if found is None:
                    continue
                entries, gflop, factor, solve, solution = found
                error = abs(A @ solution - b).max() / (abs(A) @ abs(solution) + abs(b)).max()
                # Bytes that a solve reads: L and U, or L twice.
                read = 8e-9 * entries * (1 if kind == "unsymmetric" else 2)
                print(f"{head} {A.shape[0]} | {entries:.2e} | {gflop:.3g} | {factor:.4f} | {gflop / factor:.1f} | {solve:.4f} "
                      f"| {read / solve:.1f} | {error:.0e} |", flush=True)


if __name__ == "__main__":
    main(*sys.argv[1:])
