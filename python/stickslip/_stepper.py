"""One increment after the other."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core, _dependent
from ._problem import Callback, ContactProblem, LinearSolver, vector
from ._result import Result

Array = NDArray[np.float64]


class Stepper:
    """A history in single increments, each from the end of the last one that converged; made by `ContactProblem.stepper`.

    What a run of the whole history would keep is kept: the symbolic analysis, or the condensed body. An increment that did not
    converge may be tried again, to an earlier time or under another load.

        stepper = problem.stepper()
        for force in forces:
            result = stepper.step(force).check()
    """

    def __init__(
        self, problem: ContactProblem, gap: ArrayLike, options: Mapping[str, Any], linear: str | LinearSolver | None
    ) -> None:
        self.problem = problem
        self._core = _core.Stepper(problem._core, dict(options), linear)
        self._force: Array = np.zeros(problem.n_u)
        self._gap: Array = vector("gap", gap, problem.n_c)
        self._drift: Array = np.zeros((problem.n_c, problem.tangents))
        self._mu: Array = problem.mu
        #: Symbolic analyses and numerical factorisations so far.
        self.work = {"analyses": 0, "factorizations": 0}

    @property
    def time(self) -> float:
        """The end of the last increment that converged, s."""
        return self._core.time

    def step(
        self, force: ArrayLike, *, time: float | None = None, gap: ArrayLike | None = None, drift: ArrayLike | None = None,
        mu: ArrayLike | None = None, keep_u: bool = True, callback: Callback | None = None,
    ) -> Result:
        """Goes on by an increment; between its ends loads, gaps and obstacles change evenly.

        Args:
            force: nodal forces at its end, N, (n_u,).
            time: its end, s, above `time`; a second later without it.
            gap: gaps at its end, m, a number or (n_c,); as they were without it.
            drift: how far the obstacle has moved past each node, m, (n_c,) or (n_c, d), counted from the beginning; as it was without it.
            mu: friction coefficients at its end where they change, a number or (n_c,); as they were without it.
            keep_u: whether the result has u.
            callback: as that of `ContactProblem.solve`.

        Returns:
            A result with this increment alone. Where it did not converge the stepper has not moved.
        """
        n_c, d = self.problem.n_c, self.problem.tangents
        begun = self.time
        end = begun + 1.0 if time is None else float(time)
        if not (np.isfinite(end) and end > begun):
            raise ValueError(f"time is {end:g}, but the last increment ended at {begun:g}")
        new_force = vector("force", force, self.problem.n_u)
        new_gap = self._gap if gap is None else vector("gap", gap, n_c)
        new_drift = self._drift if drift is None else vector("drift", np.ravel(drift), n_c * d).reshape(n_c, d)
        rows = self._mu if mu is None else vector("mu", mu, n_c)
        moves = bool(new_drift.any() or self._drift.any())
        first = 0 if begun == 0.0 else 1
        tables = {
            "times": [begun, end][1 - first :],
            "forces": np.stack([self._force, new_force][1 - first :]),
            "factors": np.eye(1 + first),
            "gap": np.stack([self._gap] * (1 + first) + [new_gap]),
            "drift": [
                np.stack([self._drift[:, k], new_drift[:, k]][1 - first :]) if moves and k < d else None for k in range(2)
            ],
            "mu": self.problem._friction(np.stack([self._mu, rows][1 - first :]), 1 + first),
        }
        raw = self._core.step(tables, keep_u, callback)
        self.work = {name: raw[name] for name in self.work}
        if self._core.time > begun:
            self._force, self._gap, self._drift, self._mu = new_force, new_gap, new_drift, rows
        reason = _dependent.reason(self.problem, raw["free_motion"]) if raw["status"] == "singular" else ""
        if reason and raw["free_motion"] is None:
            reason += "; `ContactProblem.solve` and `solve_increment` take such contacts"
        return Result._of(raw, d, reason=reason, stacklevel=3)

    def __repr__(self) -> str:
        return f"<Stepper at t = {self.time:g} s of {self.problem!r}>"
