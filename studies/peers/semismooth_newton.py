"""What one would write in a day: a semismooth Newton method for the whole system, with PARDISO.

    python studies/peers/semismooth_newton.py SCENE INCREMENTS N [N ...]

needs the Python module and pypardiso. The matrices and loads are those of the scene; every iteration is a factorisation. In turn with
the runs of stickslip on the same matrices: CPU seconds of whole histories, iterations, and the largest difference of contact forces.
Set the numbers of threads by OMP_NUM_THREADS, MKL_NUM_THREADS and OPENBLAS_NUM_THREADS.
"""

import sys
import time

import numpy as np
import scipy.sparse as sp
from pypardiso import PyPardisoSolver


def newton(p, forces, gap, tolerance=1e-10):
    """Forces (m, n_c, 1 + d) of all increments, and the number of iterations."""
    n, m, C_n, tangents = p.n_u, p.n_c, sp.csr_array(p.C_n), [sp.csr_array(C) for C in p.C_t]
    d, r = len(tangents), p.K.diagonal().max() * 1e-2
    B = sp.vstack([C_n, *tangents]).tocsr()
    solver = PyPardisoSolver()
    z, w_last, found, iterations = np.zeros(n + m * (1 + d)), np.zeros((m, d)), [], 0
    for f in forces:
        last = None
        for _ in range(100):
            u, p_n, p_t = z[:n], z[n:n + m], z[n + m:].reshape(d, m).T
            closed = p_n + r * (C_n @ u - gap) > 0
            trial = p_t + r * (np.stack([C @ u for C in tangents], 1) - w_last)
            size, limit = np.linalg.norm(trial, axis=1), p.mu * np.maximum(p_n, 0)
            stick = closed & (size <= limit)
            slip = closed & ~stick
            e = trial / np.where(size > 0, size, 1)[:, None]
            # Rows of contact: w_n = g or p_n = 0; w_t = w_last, p_t = mu p_n e, or p_t = 0.
            rows = [sp.diags(closed.astype(float)) @ C_n]
            blocks = [sp.diags((~closed).astype(float))]
            right = [np.where(closed, gap, 0)]
            by_n = []
            for k, C in enumerate(tangents):
                rows.append(sp.diags(stick.astype(float)) @ C)
                right.append(np.where(stick, w_last[:, k], 0))
                blocks.append(sp.diags((~stick).astype(float)))
                by_n.append(sp.diags(np.where(slip, -p.mu * e[:, k], 0)))
            D = sp.block_diag(blocks).tolil()
            for k, block in enumerate(by_n):
                D[(1 + k) * m:(2 + k) * m, :m] = block
            A = sp.bmat([[p.K, B.T], [sp.vstack(rows), D.tocsr()]]).tocsr()
            A.sort_indices()
            new = solver.solve(A, np.concatenate([f, *right]))
            iterations += 1
            change, z = np.abs(new - z)[n:].max(), new
            statuses = np.concatenate([closed, stick, slip])
            if last is not None and (statuses == last).all() and change <= tolerance * np.abs(z[n:]).max():
                break
            last = statuses
        else:
            return None, iterations
        w_last = np.stack([C @ z[:n] for C in tangents], 1)
        found.append(z[n:].reshape(1 + d, m).T.copy())
    return np.array(found), iterations


def main(scene, increments, *sizes):
    import stickslip as ss

    for size in sizes:
        elements = [int(size)] * (3 if "cube" in scene else 2)
        model = ss.Model(scene, {"mesh.elements": elements, "time.increments": int(increments)})
        p, h = model.problem, model.history
        for linear in ("umfpack", "partial", "condensed", "faer"):
            if linear == "umfpack" and not ss.UMFPACK:
                continue
            start = time.process_time()
            result = p.solve(*model.loads, gap=h["gap"], drift=h["drift"], linear=linear)
            print(f"{size:>5} {linear:>10} {time.process_time() - start:8.3f} s, {len(result.iterations)} iterations", flush=True)
        own = np.concatenate([result.p_n[:, :, None], result.p_t], axis=2)
        start = time.process_time()
        found, iterations = newton(p, h["force"], h["gap"][-1])
        seconds = time.process_time() - start
        told = "no solution" if found is None else f"forces differ by {np.abs(found - own).max() / np.abs(own).max():.1e}"
        print(f"{size:>5} {'PARDISO':>10} {seconds:8.3f} s, {iterations} iterations, {told}", flush=True)


if __name__ == "__main__":
    main(*sys.argv[1:])
