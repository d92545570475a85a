"""How far factorisations and substitutions are from the machine and from PARDISO.

    python studies/peers/limits.py SCENE N [N ...]

needs the Python module and pypardiso. For K with all contact displacements free (a Cholesky factorisation), and for the whole system
with all contact nodes stuck: seconds of PARDISO's numeric phase and of a solve, Gflop/s, entries of the factors; beside dgemm and the
speed of reading memory. `cargo bench -p stickslip-studies --bench factor` and `--bench cholesky` have the figures of UMFPACK, CHOLMOD
and faer for the same bodies. Set the numbers of threads by MKL_NUM_THREADS and OPENBLAS_NUM_THREADS.
"""

import sys
import time

import numpy as np
import scipy.sparse as sp
import stickslip as ss
from pypardiso import PyPardisoSolver


def best(work, rounds=5):
    """The least seconds of a call."""
    seconds = []
    for _ in range(rounds):
        start = time.perf_counter()
        work()
        seconds.append(time.perf_counter() - start)
    return min(seconds)


def pardiso(name, A, mtype):
    """The numeric phase and a solve of one matrix."""
    solver = PyPardisoSolver(mtype=mtype)
    # Reports entries of the factors, and Mflop of the factorisation.
    solver.set_iparm(18, -1)
    solver.set_iparm(19, -1)
    b = np.ones((A.shape[0], 1))
    call = lambda phase: (solver.set_phase(phase), solver._call_pardiso(A, b))
    call(11)
    entries, flops = int(solver.iparm[17]), 1e6 * int(solver.iparm[18])
    factor = best(lambda: call(22))
    solve = best(lambda: call(33))
    print(f"{name:>22}: {A.shape[0]:>7} unknowns, {entries:.2e} entries, {flops * 1e-9:7.2f} Gflop, factor {factor:.4f} s "
          f"({flops * 1e-9 / factor:.1f} Gflop/s), solve {solve:.4f} s ({8e-9 * entries / solve:.1f} GB/s)", flush=True)


def main(scene, *sizes):
    a = np.ones((1500, 1500))
    print(f"dgemm {2 * 1500**3 * 1e-9 / best(lambda: a @ a):.1f} Gflop/s; reading memory "
          f"{8 * 2**23 * 1e-9 / best(lambda x=np.ones(2**23): x.sum()):.1f} GB/s")
    for size in sizes:
        elements = [int(size)] * (3 if "cube" in scene else 2)
        p = ss.Model(scene, {"mesh.elements": elements}).problem
        B = sp.vstack([sp.csr_array(p.C_n), *(sp.csr_array(C) for C in p.C_t)]).tocsr()
        K = sp.csr_array(p.K)
        upper = sp.triu(K, format="csr")
        upper.sort_indices()
        pardiso(f"{size} K", upper, 2)
        whole = sp.block_array([[K, B.T], [B, sp.csr_array((B.shape[0],) * 2)]]).tocsr()
        # PARDISO wants the whole diagonal in the pattern.
        whole = (whole + sp.diags_array(np.r_[np.zeros(p.n_u), np.full(B.shape[0], 1e-300)])).tocsr()
        whole.sort_indices()
        pardiso(f"{size} whole, unsymmetric", whole, 11)
        symmetric = sp.triu(whole, format="csr")
        symmetric.sort_indices()
        pardiso(f"{size} whole, symmetric", symmetric, -2)


if __name__ == "__main__":
    main(*sys.argv[1:])
