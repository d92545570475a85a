"""Pictures, by matplotlib."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from ._judge import Comparison
    from ._result import Result

_GOOD, _BAD = "#1a7f37", "#cf222e"


def _axes(ax: Any) -> Any:
    if ax is not None:
        return ax
    import matplotlib.pyplot as plt

    return plt.subplots()[1]


def _headline(ax: Any, result: Result, text: str) -> None:
    ax.set_title(f"{text}: {result.status}", color=_GOOD if result.converged else _BAD)


def contact(result: Result, k: int = -1, ax: Any = None) -> Any:
    """Contact stresses of increment k along x (forces where there are no weights), with the statuses below."""
    ax = _axes(ax)
    n_c = result.p_n.shape[1]
    x, weight, unit = np.arange(n_c, dtype=float), np.ones(n_c), "contact force, N"
    if result.model is not None:
        x = result.model.contact_points[:, 0]
        known = result.model.problem.weight
        if known is not None:
            weight, unit = known * 1e6, "contact stress, MPa"
    order = np.argsort(x, kind="stable")
    ax.plot(x[order], (result.p_n[k] / weight)[order], label="normal")
    for d in range(result.p_t.shape[2]):
        ax.plot(x[order], (result.p_t[k, :, d] / weight)[order], label="tangential" if result.p_t.shape[2] == 1 else f"tangential {d + 1}")
    low = min(0.0, *ax.get_ylim())
    for code, name, marker in ((0, "open", "_"), (1, "stick", "s"), (2, "slip", "o")):
        here = result.contact[k] == code
        if here.any():
            ax.plot(x[here], np.full(int(here.sum()), low), marker, markersize=4, label=name)
    ax.set_xlabel("x, m" if result.model is not None else "contact node")
    ax.set_ylabel(unit)
    ax.legend()
    _headline(ax, result, f"t = {result.t[k]:g} s")
    return ax


def convergence(result: Result, ax: Any = None) -> Any:
    """The error of every law over the increments, on a logarithmic scale."""
    from ._result import LAWS

    ax = _axes(ax)
    for law, column in zip(LAWS, result.errors.T):
        ax.semilogy(result.t, np.where(column > 0, column, np.nan), ".-", label=law)
    ax.set_xlabel("t, s")
    ax.set_ylabel("relative error")
    ax.legend()
    _headline(ax, result, "errors by law")
    return ax


def history(result: Result, ax: Any = None) -> Any:
    """Sums of the contact forces over time."""
    ax = _axes(ax)
    ax.plot(result.t, result.p_n.sum(axis=1), ".-", label="sum of p_n")
    for d in range(result.p_t.shape[2]):
        ax.plot(result.t, result.p_t[:, :, d].sum(axis=1), ".-", label="sum of p_t" if result.p_t.shape[2] == 1 else f"sum of p_t, tangent {d + 1}")
    ax.set_xlabel("t, s")
    ax.set_ylabel("force, N")
    ax.legend()
    _headline(ax, result, "contact forces")
    return ax


def comparison(table: Comparison, ax: Any = None) -> Any:
    """Error against CPU time; what breaks a law by more than the tolerance is red."""
    ax = _axes(ax)
    for k, verdict in enumerate(table.verdicts):
        colour, at = _GOOD if verdict.holds else _BAD, (max(verdict.seconds, 1e-6), max(verdict.error, 1e-17))
        ax.loglog(*at, "o", color=colour)
        # Above and below in turn, for those that are near each other.
        ax.annotate(verdict.name, at, (0, 6 if k % 2 else -14), textcoords="offset points", ha="center", color=colour)
    ax.margins(0.25)
    ax.axhline(table.tolerance, linestyle=":", color="grey")
    ax.set_xlabel("CPU time, s")
    ax.set_ylabel("largest error of any law")
    return ax
