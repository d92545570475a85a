"""Problems whose contact rows depend on each other: their forces are not unique, and Newton's matrices are singular.

A rigid box on four corners is one. The cascade for local problems, which `stickslip solve` uses, solves them.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray
from scipy.linalg import qr

from ._words import few

if TYPE_CHECKING:
    from ._options import Callback
    from ._problem import ContactProblem

Array = NDArray[np.float64]

#: Rows beyond which dependence is not looked for: the matrix of their products is full.
_ROWS = 2000


def dependent_nodes(problem: ContactProblem) -> list[int]:
    """The contact nodes whose rows of C_n and C_t are sums of rows of other nodes or of each other."""
    rough = problem.mu > 0
    maps = [problem.C_n, *(sp.diags(rough.astype(float)) @ C for C in problem.C_t)]
    C: Any = sp.csr_array(sp.vstack(maps, format="csr"))
    size = np.sqrt(np.asarray(C.multiply(C).sum(axis=1)).ravel())
    used = np.flatnonzero(size > 0)
    if not len(used) or len(used) > _ROWS:
        return []
    C = sp.diags(1.0 / size[used]) @ C[used]
    _, R, order = qr((C @ C.T).toarray(), mode="economic", pivoting=True)
    pivots = abs(np.diag(R))
    independent = int((pivots > len(used) * np.finfo(float).eps * pivots[0]).sum())
    if independent == len(used):
        return []
    # A row that depends on others, and the others that its sum is made of.
    head = R[:independent, :independent]
    weights = abs(np.linalg.solve(head, R[:independent, independent:]))
    parts = (weights > 1e-8 * weights.max(initial=0.0)).any(axis=1)
    rows = np.concatenate([order[:independent][parts], order[independent:]])
    return sorted({int(row) for row in used[rows] % problem.n_c})


def reason(problem: ContactProblem, free_motion: list[float] | None) -> str:
    """The reason why the equations are singular."""
    if free_motion is not None:
        weights = ", ".join(f"{weight:.3g}" for weight in free_motion)
        return f"neither K nor contact stops the body along the sum of its free_motions with the weights [{weights}]"
    nodes = dependent_nodes(problem)
    if not nodes:
        return ""
    return f"the rows of C_n and C_t of the contact node{'s' * (len(nodes) > 1)} {few(nodes, 8)} depend on each other, so that their forces are not unique"


def rescued(
    problem: ContactProblem, raw: dict[str, Any], tables: dict[str, Any], options: dict[str, Any], keep: bool | list[int],
    callback: Callback | None,
) -> tuple[dict[str, Any], str]:
    """A run of the core, or that of the cascade where dependent rows have ended it, and why it ended."""
    if raw["status"] != "singular":
        return raw, raw.get("reason", "")
    why = reason(problem, raw["free_motion"])
    supported = raw["free_motion"] is None and not len(problem.free_motions)
    if not why or not supported or len(raw["p_n"]) or options["method"] == "events":
        return raw, why
    raw = solve(problem, tables, options["tolerance"] or 1e-10, keep, callback)
    return raw, "" if raw["status"] == "converged" else why


def solve(
    problem: ContactProblem, tables: dict[str, Any], tolerance: float, keep: bool | list[int], callback: Callback | None
) -> dict[str, Any]:
    """A history in the shape of the core's, each increment by the cascade and judged by the error measure."""
    from ._judge import errors
    from ._result import LAWS

    n_u, n_c, d = problem.n_u, problem.n_c, problem.tangents
    times, force = tables["times"], tables["factors"] @ tables["forces"]
    gaps = np.broadcast_to(tables["gap"][-len(times):], (len(times), n_c))
    mus = np.broadcast_to(problem.mu if tables["mu"] is None else tables["mu"], (len(times), n_c))
    drifts = np.stack([np.zeros((len(times), n_c)) if drift is None else drift for drift in tables["drift"]], axis=-1)
    u, p_n, p_t = np.zeros(n_u), np.zeros(n_c), np.zeros((n_c, 2))
    scales: tuple[float, ...] = ()
    slip, moved = np.zeros((n_c, 2)), np.zeros((n_c, 2))
    status, records, rows = "converged", list[dict[str, Any]](), list[tuple[Array, ...]]()
    for k, time in enumerate(times):
        w = slip + drifts[k] - moved
        posed = {
            "force": force[k], "gap": gaps[k], "mu": mus[k], "w_last": [np.ascontiguousarray(w[:, j]) for j in range(2)],
            "u": u, "u_rest": np.zeros(0), "p_n": p_n, "p_t": np.ascontiguousarray(p_t[:, 0]), "p_o": np.ascontiguousarray(p_t[:, 1]),
        }
        try:
            found = problem._core.cascade(max(2, 1 + d), posed)
        except ValueError:
            status = "singular"
            break
        u, p_n, p_t = np.array(found[0]), np.array(found[1]), np.stack([np.array(found[2]), np.array(found[3])], axis=-1)
        judged = errors(problem, force[k], u, p_n, p_t[:, :d], gap=gaps[k], w_t_last=w[:, :d], mu=mus[k], scales=scales)
        holds = judged.worst[1] <= tolerance
        status = "converged" if holds else "singular"
        kkt = {law: getattr(judged, law) for law in LAWS}
        slid = float((p_t[:, :d] * (problem.slip(u) - w[:, :d])).sum())
        energy = 0.5 * float(u @ (problem.K @ u))
        records.append({
            "index": k + 1, "time": float(time), "status": status, "iterations": found[4], "parts": 1, "kkt": kkt,
            "friction_work": slid, "strain_energy": energy,
        })
        rows.append((u, force[k], p_n, p_t, judged.contact, gaps[k], mus[k], w))
        if callback is not None:
            callback(k + 1, float(time), status, found[4], judged.worst[1])
        if not holds:
            break
        scales, moved = judged.scales, drifts[k]
        slip[:, :d] = problem.slip(u)
    return _raw(status, records, rows, keep, (n_u, n_c))


def _raw(
    status: str, records: list[dict[str, Any]], rows: list[tuple[Array, ...]], keep: bool | list[int], sizes: tuple[int, int]
) -> dict[str, Any]:
    n_u, n_c = sizes
    numbers = range(1, len(rows) + 1)
    wanted = numbers if keep is True else [] if keep is False else [k for k in numbers if k in keep or (0 in keep and k == len(rows))]

    def table(place: int, width: int, of: Any = numbers, tangent: int | None = None) -> Array:
        values = [rows[k - 1][place] if tangent is None else rows[k - 1][place][:, tangent] for k in of]
        return np.array(values).reshape(-1, width)

    return {
        "status": status, "records": records, "kept": list(wanted), "iterations": np.zeros((0, 5)),
        "u": table(0, n_u, wanted), "u_rest": np.zeros((len(wanted), n_u)), "force": table(1, n_u, wanted),
        "p_n": table(2, n_c), "p_t": table(3, n_c, tangent=0), "p_o": table(3, n_c, tangent=1), "contact": table(4, n_c),
        "gap": table(5, n_c), "mu": table(6, n_c), "w_t_last": table(7, n_c, tangent=0), "w_o_last": table(7, n_c, tangent=1),
    }
