"""Pictures, by matplotlib."""

from __future__ import annotations

from typing import Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from ._fields import Fields, _Body
from ._kinds import LAWS, OPEN, SLIP, STICK

Array = NDArray[Any]

GOOD, BAD = "#1a7f37", "#cf222e"
#: Normal and tangential forces.
_FORCES = ("#0072b2", "#d55e00", "#cc79a7")
#: Code, name, colour and marker of each status: in every picture the same.
_STATUSES = ((OPEN, "open", "#999999", "_"), (STICK, "stick", "#009e73", "s"), (SLIP, "slip", "#e69f00", "o"))


def axes(ax: Any) -> Any:
    """New axes for None."""
    if ax is not None:
        return ax
    import matplotlib.pyplot as plt

    return plt.subplots()[1]


def _headline(ax: Any, result: Fields, text: str) -> None:
    ax.set_title(f"{text}: {result.status}", color=GOOD if result.status == "converged" else BAD)


def _chains(points: Array, linked: Any) -> list[list[int]]:
    """The points in rows along curves, each from one end to the other; `linked` says which are of one cell."""
    left, chains = set(range(len(points))), []

    def walk(start: int, free: set[int]) -> list[int]:
        chain = [start]
        while True:
            here = chain[-1]
            near = [k for k in linked.indices[linked.indptr[here] : linked.indptr[here + 1]] if k in free and k not in chain[-3:]]
            free = free - {here}
            if not near:
                return chain
            chain.append(min(near, key=lambda k: float(np.linalg.norm(points[k] - points[here]))))

    while left:
        # The first walk finds an end, the second begins there.
        chain = walk(walk(min(left), left)[-1], left)
        chains.append(chain)
        left -= set(chain)
    return chains


def _curves(model: _Body) -> list[tuple[str, Array, Array]]:
    """Name, contact nodes and lengths along it of each curve with contact in the plane."""
    rows = np.concatenate([np.repeat(np.arange(len(nodes)), nodes.shape[1]) for _, nodes in model.cells])
    starts = np.repeat(np.cumsum([0, *[len(nodes) for _, nodes in model.cells]])[:-1], [nodes.size for _, nodes in model.cells])
    columns = np.concatenate([nodes.ravel() for _, nodes in model.cells])
    of_cells = sp.csc_array((np.ones(len(rows)), (rows + starts, columns)))
    curves = []
    for name, contacts in model.boundaries.items():
        own = of_cells[:, model.contact_nodes[contacts]]
        points = model.contact_points[contacts]
        for chain in _chains(points, (own.T @ own).tocsr()):
            steps = np.linalg.norm(np.diff(points[chain], axis=0), axis=1)
            curves.append((name, contacts[chain], np.concatenate([[0.0], np.cumsum(steps)])))
    return curves


def _abscissae(model: _Body) -> tuple[list[tuple[str, Array, Array]], str]:
    """Name, contact nodes and abscissae of each curve, and what these are: x, or lengths along the boundaries, one beside the other."""
    curves = _curves(model)
    by_x = [(name, nodes, model.contact_points[nodes, 0]) for name, nodes, _ in curves]
    forth = all((np.diff(x) > 0).all() or (np.diff(x) < 0).all() for _, _, x in by_x)
    ends = sorted((x.min(), x.max()) for _, _, x in by_x)
    if forth and all(left[1] < right[0] for left, right in zip(ends, ends[1:])):
        return by_x, "x, m"
    space = 0.05 * sum(s[-1] for _, _, s in curves)
    starts = np.cumsum([0.0, *[s[-1] + space for _, _, s in curves]])
    beside = [(name, nodes, start + s) for (name, nodes, s), start in zip(curves, starts)]
    return beside, "along the boundary, m" if len(curves) == 1 else "along the boundaries, one beside the other"


def contact(result: Fields, k: int = -1, ax: Any = None) -> Any:
    """`Result.plot`."""
    k = result._number(k)
    ax = axes(ax)
    model, d = result.model, result.p_t.shape[2]
    if model is None:
        normal, tangential, unit = result.p_n[k], result.p_t[k], "contact force, N"
    else:
        stresses = result._contact(k)
        normal, tangential, unit = stresses["pressure"] / 1e6, stresses["traction"] / 1e6, "contact stress, MPa"
    if model is not None and d == 2:
        _map(result, model, k, ax, normal, unit)
    else:
        numbers = np.arange(len(normal))
        curves, across = ([("", numbers, numbers)], "contact node") if model is None else _abscissae(model)
        names = ("normal", "tangential") if d == 1 else ("normal", *(f"tangential {j + 1}" for j in range(d)))
        for place, (_, nodes, x) in enumerate(curves):
            for j, (colour, name) in enumerate(zip(_FORCES, names)):
                stress = normal if j == 0 else tangential[:, j - 1]
                # Numbers of nodes say nothing of neighbours: points without a line.
                ax.plot(x, stress[nodes], "." if model is None else "-", color=colour, label="" if place else name)
        low = min(0.0, *ax.get_ylim())
        for code, name, colour, marker in _STATUSES:
            here = np.concatenate([x[result.contact[k, nodes] == code] for _, nodes, x in curves])
            if len(here):
                ax.plot(here, np.full(len(here), low), marker, color=colour, markersize=4, label=name)
        _name(ax, [(name, float(x.mean())) for name, _, x in curves])
        ax.set_xlabel(across)
        ax.set_ylabel(unit)
    ax.legend()
    _headline(ax, result, f"t = {result.t[k]:g} s")
    return ax


def _name(ax: Any, places: list[tuple[str, float]]) -> None:
    """The names of boundaries below them, if there are several."""
    if len(places) > 1:
        ax.set_xticks([x for _, x in places], [name for name, _ in places])


def _map(result: Fields, model: _Body, k: int, ax: Any, stress: Array, unit: str) -> None:
    """Contact nodes in space: filled by the normal stress, outlined by the status; one boundary beside the other."""
    at, names, start, axes = np.zeros((len(stress), 2)), [], 0.0, (0, 1)
    size = np.ptp(model.contact_points, axis=0).max()
    for name, nodes in model.boundaries.items():
        points = model.contact_points[nodes]
        a, b = sorted(np.argsort(np.ptp(points, axis=0), kind="stable")[1:])
        axes = (a, b)
        shift = start - points[:, a].min() if len(model.boundaries) > 1 else 0.0
        at[nodes] = points[:, [a, b]] + [shift, 0.0]
        names.append((name, float(at[nodes, 0].mean())))
        start = at[nodes, 0].max() + 0.15 * size
    colours = np.array([colour for _, _, colour, _ in _STATUSES])[result.contact[k]]
    area = max(4.0, min(40.0, 8000.0 / len(at)))
    shown = ax.scatter(at[:, 0], at[:, 1], c=stress, cmap="Greys", edgecolors=colours, linewidths=0.2 * area**0.5, s=area)
    ax.figure.colorbar(shown, ax=ax, label=f"normal {unit}")
    for code, name, colour, _ in _STATUSES:
        if (result.contact[k] == code).any():
            ax.plot([], [], "o", markerfacecolor="none", markeredgecolor=colour, label=name)
    one = len(names) == 1
    ax.set_xlabel(f"{'xyz'[axes[0]]}, m" if one else "the boundaries, one beside the other")
    ax.set_ylabel(f"{'xyz'[axes[1]]}, m" if one else "m")
    ax.set_aspect("equal")
    _name(ax, names)


def convergence(result: Fields, ax: Any = None) -> Any:
    """`Result.plot_convergence`."""
    ax = axes(ax)
    for law, column in zip(LAWS, result.errors.T):
        ax.semilogy(result.t, np.where(column > 0, column, np.nan), ".-", label=law)
    ax.set_xlabel("t, s")
    ax.set_ylabel("relative error")
    ax.legend()
    _headline(ax, result, "errors by law")
    return ax


def history(result: Fields, ax: Any = None) -> Any:
    """`Result.plot_history`."""
    ax = axes(ax)
    ax.plot(result.t, result.p_n.sum(axis=1), ".-", label="sum of p_n")
    for d in range(result.p_t.shape[2]):
        ax.plot(result.t, result.p_t[:, :, d].sum(axis=1), ".-", label="sum of p_t" if result.p_t.shape[2] == 1 else f"sum of p_t, tangent {d + 1}")
    ax.set_xlabel("t, s")
    ax.set_ylabel("force, N")
    ax.legend()
    _headline(ax, result, "contact forces")
    return ax
