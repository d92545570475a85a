#!/usr/bin/env python3
"""Contact forces of a scene by stickslip, Siconos, GetFEM and a semismooth Newton method, in one run on one machine.

    python3 studies/peers/compare.py --n 50,100 --increments 20+20
    python3 studies/peers/compare.py --scene data/scenes/cube.toml --n 8,10,16 --increments 5+5
    python3 studies/peers/compare.py --n 100 --increments 20+20 --only "GetFEM"         one row, or those whose names begin so

needs the program (`--program`), the Python module, numpy and scipy. Peers that are not installed are skipped with the package to install.
Debian's Siconos needs numpy 1. One environment for all:

    apt-get install --no-install-recommends python3-venv python3-scipy python3-siconos python3-getfem
    /usr/bin/python3 -m venv --system-site-packages peers && peers/bin/pip install pypardiso && peers/bin/pip install ./python
    peers/bin/python studies/peers/compare.py --only stickslip --only "Siconos condensed"

Every peer gets the matrices and loads of the scene, in units in which the largest entries of K and of the loads are 1, because the
tolerances of the peers are absolute. Tolerances are 1e-10, of GetFEM 1e-8: its residual does not fall below 1e-10 on the block with n = 100.
Every increment begins with the forces of the increment before. The gap is 0: where nodes first touch within an increment, the program divides
it, and the peers do not.
Each run is a process of its own with one thread:

    CPU s      user and system time; of the program its whole process, of a peer all work from the matrices to the last forces
    W s        the part of it that condenses the body to its contact displacements by SciPy's SuperLU
    wall s     elapsed time of the same work
    MB         peak memory of the whole process; `before`: with Python, the modules and the matrices, before the solution
    difference of contact forces to those of `stickslip umfpack`, as a share of the largest force
    residual   of the contact laws, computed here from the forces alone, see `residual`; an answer above 1e-6 is marked as wrong

Siconos 4.4 does not free the factors of NSN_AC and ADMM on the whole system: their memory grows with the increments. Its NSGS on the whole system
is given 1000 sweeps; on the cube with n = 4 it is still at forces of 0 after 20 000.
"""

import argparse
import csv
import json
import os
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from types import SimpleNamespace

ONE_THREAD = {name: "1" for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")}
os.environ |= ONE_THREAD

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import splu

TOLERANCE = 1e-10


class GaveUp(Exception):
    """A peer that says itself that it has no answer."""


# The peers. Each takes a body: K; C, whose rows are normal, tangents of node after node; mu; force and gap of all increments. It returns
# forces (increments, nodes, 1 + tangents) and the seconds of condensing. Equilibrium is K u + C' p = f, and C_n u <= gap.


def factored(K):
    """A sparse LU of the symmetric K."""
    return splu(K.tocsc(), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})


def third(body):
    """A body in space: nodes of the plane get a displacement out of it, which a spring of stiffness 1 holds."""
    if body.d == 3:
        return body.K, body.C
    n, m = body.K.shape[0], body.m
    C = sp.bmat([[body.C, None], [None, sp.eye(m)]]).tocsr()
    return sp.block_diag([body.K, sp.eye(m)]).tocsc(), C[np.column_stack([np.arange(2 * m).reshape(m, 2), 2 * m + np.arange(m)]).ravel()]


def siconos_options(name):
    import siconos.numerics as sn

    options = sn.SolverOptions(getattr(sn, name))
    options.dparam[sn.SICONOS_DPARAM_TOL] = TOLERANCE
    options.iparam[sn.SICONOS_IPARAM_MAX_ITER] = 1000 if name == "SICONOS_GLOBAL_FRICTION_3D_NSGS" else 100_000
    if "NSN_AC" in name:
        options.iparam[sn.SICONOS_FRICTION_3D_NSN_LINEAR_SOLVER] = sn.SICONOS_FRICTION_3D_NSN_USE_MUMPS
    return options


def siconos_whole(name, body):
    """The driver gfc3d of M v = q + H r, u = H' v + b; the normal of u is gap - C_n u, that of r is p_n, and the tangents of r are -p_t."""
    import siconos.numerics as sn

    K, C = third(body)
    n, m, keep, found = body.K.shape[0], body.m, [], []
    H = (sp.diags(np.tile([-1.0, 1.0, 1.0], m)) @ C).T.tocsc()
    problem = sn.GlobalFrictionContactProblem()
    problem.dimension, problem.numberOfContacts, problem.M, problem.H, problem.mu = 3, m, K, H, body.mu
    v, u, r, slip = np.zeros(K.shape[0]), np.zeros(3 * m), np.zeros(3 * m), np.zeros((m, 3))
    for k, (force, gap) in enumerate(zip(body.force, body.gap)):
        options = siconos_options("SICONOS_GLOBAL_FRICTION_3D_" + name)
        problem.q = q = np.r_[force, np.zeros(K.shape[0] - n)]
        problem.b = b = np.column_stack([gap, -slip[:, 1:]]).ravel()
        keep.append((options, q, b))  # 4.4 corrupts the heap when options are used again; it keeps all factors of Newton's method itself
        info = sn.gfc3d_driver(problem, r, u, v, options)
        if info:
            raise GaveUp(f"increment {k + 1}: the driver returns {info}")
        slip = (C @ v).reshape(m, 3)
        found.append(r.reshape(m, 3) * [1, -1, -1])
    return np.array(found)[:, :, : body.d], 0.0


def siconos_condensed(name, body):
    """The drivers fc2d and fc3d of u = W r + q with W = H' M^-1 H, dense."""
    import siconos.numerics as sn

    start = time.process_time()
    lu, d, m = factored(body.K), body.d, body.m
    signs = np.tile([-1.0, 1.0, 1.0][:d], m)
    W = signs[:, None] * (body.C @ lu.solve(body.C.T.toarray())) * signs
    W = np.asfortranarray(0.5 * (W + W.T))
    seconds = time.process_time() - start
    D = 2 if name.startswith("2D") else 3
    rows = np.arange(D * m).reshape(m, D)[:, :d].ravel()
    whole = np.asfortranarray(np.eye(D * m))
    whole[np.ix_(rows, rows)] = W
    r, u, slip, keep, found = np.zeros(D * m), np.zeros(D * m), np.zeros((m, d)), [], []
    problem, driver = sn.FrictionContactProblem(D, m, whole, np.zeros(D * m), body.mu), sn.fc2d_driver if D == 2 else sn.fc3d_driver
    for k, (force, gap) in enumerate(zip(body.force, body.gap)):
        options, q = siconos_options("SICONOS_FRICTION_" + name), np.zeros(D * m)
        free = body.C @ lu.solve(force)
        q[rows] = signs * free + np.column_stack([gap, -slip[:, 1:]]).ravel()
        problem.q = q
        keep.append((options, q))
        info = driver(problem, r, u, options)
        if info:
            raise GaveUp(f"increment {k + 1}: the driver returns {info}")
        slip = (free + signs * (W @ r[rows])).reshape(m, d)
        found.append((r[rows] * -signs).reshape(m, d))
    return np.array(found), seconds


def getfem(version, body):
    """Its basic contact brick with these matrices: an augmented Lagrangian with nodal forces, a Newton iteration with MUMPS."""
    import getfem as gf
    from scipy.io import mmwrite

    def spmat(A):
        with tempfile.NamedTemporaryFile(suffix=".mtx") as file:
            mmwrite(file.name, sp.coo_matrix(A), precision=17, symmetry="general")
            return gf.Spmat("load", "mm", file.name)

    gf.util("trace level", 0)
    n, d, m = body.K.shape[0], body.d, body.m
    K, normal, tangent = (spmat(A) for A in (body.K, body.C[::d], body.C[np.arange(d * m) % d > 0]))
    body.start = clocks()
    model = gf.Model("real")
    for name, size in (("u", n), ("p_n", m), ("p_t", (d - 1) * m)):
        model.add_variable(name, size)
    data = {"r": 1.0, "mu": body.mu, "gap": body.gap[0], "alpha": np.ones(m), "gamma": -1.0, "last": np.zeros(n)}
    for name, value in data.items():
        model.add_initialized_data(name, value)
    model.add_explicit_matrix("u", "u", K, 1, 1)
    load = model.add_explicit_rhs("u", np.zeros(n))
    model.add_basic_contact_brick("u", "p_n", "p_t", "r", normal, tangent, "mu", "gap", "alpha", version, "gamma", "last")
    found = []
    for k, (force, gap) in enumerate(zip(body.force, body.gap)):
        model.set_private_rhs(load, force)
        model.set_variable("gap", gap)
        _, converged = model.solve("max_res", 100 * TOLERANCE, "max_iter", 100, "lsolver", "mumps")
        if not converged:
            raise GaveUp(f"increment {k + 1}: no convergence in 100 iterations")
        model.set_variable("last", model.variable("u"))
        found.append(-np.column_stack([model.variable("p_n"), model.variable("p_t").reshape(m, d - 1)]))
    return np.array(found), 0.0


def pardiso(_, body):
    """`semismooth_newton.py` beside this file."""
    from semismooth_newton import newton

    problem = SimpleNamespace(
        n_u=body.K.shape[0], n_c=body.m, K=body.K, C_n=body.C[:: body.d], C_t=[body.C[k :: body.d] for k in range(1, body.d)], mu=body.mu
    )
    found, iterations = newton(problem, body.force, body.gap[0], TOLERANCE)
    if found is None:
        raise GaveUp(f"no convergence in 100 iterations of an increment, {iterations} in all")
    return found, 0.0


#: name: (dimensions, module, what to install, function, its first argument)
SICONOS = ("siconos.numerics", "Debian package python3-siconos")
PEERS = {
    "Siconos whole, NSN_AC": ((2, 3), *SICONOS, siconos_whole, "NSN_AC"),
    "Siconos whole, ADMM": ((2, 3), *SICONOS, siconos_whole, "ADMM"),
    "Siconos whole, NSGS": ((2, 3), *SICONOS, siconos_whole, "NSGS"),
    "GetFEM, augmented Lagrangian 1": ((2, 3), "getfem", "Debian package python3-getfem", getfem, 1),
    "GetFEM, augmented Lagrangian 2": ((2, 3), "getfem", "Debian package python3-getfem", getfem, 2),
    "Python, semismooth Newton, PARDISO": ((2, 3), "pypardiso", "`pip install pypardiso`", pardiso, ""),
    "Siconos condensed, NSN_AC": ((2, 3), *SICONOS, siconos_condensed, "3D_NSN_AC"),
    "Siconos condensed, ADMM": ((2, 3), *SICONOS, siconos_condensed, "3D_ADMM"),
    "Siconos condensed, NSGS": ((2, 3), *SICONOS, siconos_condensed, "3D_NSGS"),
    "Siconos condensed, plane NSGS": ((2,), *SICONOS, siconos_condensed, "2D_NSGS"),
    "Siconos condensed, plane LEMKE": ((2,), *SICONOS, siconos_condensed, "2D_LEMKE"),
}
OWN = {f"stickslip {solver}": solver for solver in ("auto", "umfpack", "partial", "condensed")}


# A peer, in a process of its own.


def clocks():
    """Elapsed and CPU seconds."""
    return np.array([time.perf_counter(), time.process_time()])


def memory(key):
    """VmRSS or VmHWM of this process, MB."""
    lines = Path("/proc/self/status").read_text().splitlines()
    return next(int(line.split()[1]) for line in lines if line.startswith(key)) * 1.024e-3


def child(name, folder):
    """Solves the body in `folder`, and leaves the forces there."""
    _, module, _, solve, argument = PEERS[name]
    __import__(module)
    arrays = np.load(folder / "body.npz")
    body = SimpleNamespace(K=sp.load_npz(folder / "K.npz"), C=sp.load_npz(folder / "C.npz"), **arrays)
    body.m = len(body.mu)
    body.d = body.C.shape[0] // body.m
    told = {"before": memory("VmRSS"), "stopped": ""}
    body.start = clocks()
    try:
        forces, told["condensing"] = solve(argument, body)
        np.save(folder / "forces.npy", forces)
    except GaveUp as reason:
        told["stopped"] = str(reason)
    told["wall"], told["cpu"] = clocks() - body.start
    told["MB"] = memory("VmHWM")
    (folder / "told.json").write_text(json.dumps(told))


def run_peer(name, folder, limit):
    for file in ("forces.npy", "told.json"):
        (folder / file).unlink(missing_ok=True)
    command = [sys.executable, __file__, "--child", name, str(folder)]
    try:
        done = subprocess.run(command, timeout=limit, capture_output=True, text=True)
    except subprocess.TimeoutExpired:
        return {"stopped": f"no answer in {limit:g} s"}
    if not (folder / "told.json").exists():
        return {"stopped": f"exit status {done.returncode}: {(done.stderr.strip().splitlines() or ['no message'])[-1][:80]}"}
    told = json.loads((folder / "told.json").read_text())
    return told | ({"forces": np.load(folder / "forces.npy")} if (folder / "forces.npy").exists() else {})


# The program.


def run_program(case, solver, *more):
    command = [case.program, "run", case.scene, "--solver", solver, "--setting", "default", "--threads", "1", "--json", *more]
    command += [word for key, value in case.overrides.items() for word in ("--set", f"{key}={value}")]
    before, start = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    done = subprocess.run(command, capture_output=True, text=True)
    after, wall = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter() - start
    if done.returncode:
        return {"stopped": f"exit status {done.returncode} of " + " ".join(command)}
    cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return {"cpu": cpu, "wall": wall, "MB": json.loads(done.stdout)["totals"]["peak_rss_bytes"] * 1e-6, "stopped": ""}


def program_forces(case, solver, model, folder):
    """Forces from the contact lines of all increments, in units of the load."""
    times = [float(f"{t:.12g}") for t in model.t]
    out = str(folder / f"out-{solver}")
    told = run_program(case, solver, "--out", out, "--set", f"output.times={times}", "--set", "output.fields=false")
    if told["stopped"]:
        return told
    found = []
    for k in range(len(times)):
        with open(f"{out}/contact_{k + 1:04}.csv") as file:
            rows = list(csv.DictReader(file))
        assert [int(row["node"]) for row in rows] == [int(node) for node in model.contact_nodes]
        found.append([[float(row[key]) for key in ("p_n", "p_t", "p_o") if key in row] for row in rows])
    return {"forces": np.array(found) / case.unit, "stopped": ""}


# The judge.


def residual(body, lu, forces):
    """The largest violation of the contact laws in all increments, as a share of the largest force.

    Displacements are u = K^-1 (f - C' p), with refinement in extended precision: equilibrium holds. With r, the largest entry of K, the laws of a node are
    p_n = max(0, p_n + r (w_n - gap)) and p_t = the point of the disk of radius mu p_n nearest to p_t + r (w_t - w_t of the increment before).
    """
    K, worst, r, slip = body.K.astype(np.longdouble), 0.0, abs(body.K).max(), 0.0
    for force, gap, p in zip(body.force, body.gap, forces):
        loads, u = force - body.C.T @ p.ravel(), np.zeros(K.shape[0], np.longdouble)
        for _ in range(3):
            u = u + lu.solve((loads - K @ u).astype(float))
        w = (body.C @ u).reshape(p.shape)
        normal = p[:, 0] - np.maximum(0, p[:, 0] + r * (w[:, 0] - gap))
        trial = p[:, 1:] + r * (w[:, 1:] - slip)
        size, limit = np.linalg.norm(trial, axis=1), body.mu * np.maximum(p[:, 0], 0)
        nearest = trial * np.minimum(1, limit / np.where(size > 0, size, 1))[:, None]
        worst = max(worst, abs(normal).max(), abs(p[:, 1:] - nearest).max())
        slip = w[:, 1:]
    return worst / abs(forces).max()


def handed(model, folder):
    """The body of a scene in units near 1, also as files for the peers; and its unit of force, N."""
    problem, history = model.problem, model.history
    assert not history["drift"].any(), "the obstacle moves: the peers are not told of that"
    maps = [problem.C_n, *problem.C_t]
    d, m = len(maps), problem.n_c
    stiffness, unit = abs(problem.K).max(), abs(history["force"]).max()
    body = SimpleNamespace(
        K=sp.csc_matrix(problem.K) / stiffness, C=sp.csr_matrix(sp.vstack(maps))[np.arange(d * m).reshape(d, m).T.ravel()],
        force=history["force"] / unit, gap=history["gap"][1:] * stiffness / unit, mu=np.array(problem.mu), m=m, d=d,
    )
    sp.save_npz(folder / "K.npz", body.K, compressed=False)
    sp.save_npz(folder / "C.npz", body.C, compressed=False)
    np.savez(folder / "body.npz", force=body.force, gap=body.gap, mu=body.mu)
    return body, unit


def installed(module):
    # In a process of its own: a peer may have libraries that do not go with those of another.
    return subprocess.run([sys.executable, "-c", f"import {module}"], capture_output=True).returncode == 0


def compare(case, n, rounds, limit, only, folder):
    import stickslip as ss

    dimension = 3 if "cube" in Path(case.scene).name else 2
    case.overrides = {"mesh.elements": [n] * dimension, "time.increments": case.increments, "contact.obstacle.gap": 0}
    model = ss.Model(case.scene, case.overrides)
    body, case.unit = handed(model, folder)
    lu = factored(body.K)
    print(f"\n{Path(case.scene).stem}, n = {n}: {body.K.shape[0]} displacements, {body.m} contact nodes, {case.increments} increments; "
          f"load average {os.getloadavg()[0]:.1f}\n")
    print("| program | CPU s | W s | wall s | MB | before | difference | residual |\n| --- | --- | --- | --- | --- | --- | --- | --- |")
    reference = program_forces(case, "umfpack", model, folder)
    if reference["stopped"]:
        sys.exit(reference["stopped"])
    for name in [*OWN, *PEERS]:
        if not any(name.startswith(word) for word in only):
            continue
        if name in PEERS:
            dimensions, module, package = PEERS[name][:3]
            if dimension not in dimensions:
                continue
            if not installed(module):
                print(f"| {name} | skipped: {module} is not installed, {package} | | | | | | |")
                continue
        runs = []
        while not runs or (len(runs) < rounds and not runs[-1]["stopped"] and sum(run["wall"] for run in runs) < 120):
            runs.append(run_program(case, OWN[name]) if name in OWN else run_peer(name, folder, limit))
        best = min(runs, key=lambda run: run.get("cpu", np.inf))
        if name in OWN and not best["stopped"]:
            best |= program_forces(case, OWN[name], model, folder)
        if best["stopped"]:
            cells = [f"{best['cpu']:.3g}" if "cpu" in best else "", "", "", "", "", "none", best["stopped"]]
        else:
            forces, exact = best["forces"], reference["forces"]
            error = residual(body, lu, forces)
            cells = [
                f"{best['cpu']:.3g}", f"{best['condensing']:.2g}" if best.get("condensing") else "", f"{best['wall']:.3g}", f"{best['MB']:.0f}",
                f"{best['before']:.0f}" if "before" in best else "", f"{abs(forces - exact).max() / abs(exact).max():.0e}",
                f"{error:.0e}" + (" WRONG" if not error <= 1e-6 else ""),
            ]
        print(f"| {name} | {' | '.join(cells)} |", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scene", default="data/scenes/block.toml")
    parser.add_argument("--n", default="50,100", help="elements along an edge, one or several")
    parser.add_argument("--increments", default="20+20", help="of each path of the load, which are equally long")
    parser.add_argument("--only", action="append", help="names of rows, or how they begin; may be repeated")
    parser.add_argument("--rounds", type=int, default=3, help="runs of each, of which the least CPU time counts; fewer beyond two minutes")
    parser.add_argument("--limit", type=float, default=600, help="seconds that a peer may take")
    parser.add_argument("--program", default="target/release/stickslip")
    parser.add_argument("--child", nargs=2, help=argparse.SUPPRESS)
    given = parser.parse_args()
    if given.child:
        return child(given.child[0], Path(given.child[1]))
    case = SimpleNamespace(program=given.program, scene=given.scene, increments=sum(map(int, given.increments.split("+"))))
    for n in map(int, given.n.split(",")):
        with tempfile.TemporaryDirectory() as folder:
            compare(case, n, given.rounds, given.limit, given.only or [""], Path(folder))


if __name__ == "__main__":
    main()
