"""One increment after the other."""

from __future__ import annotations

from numbers import Real
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from . import _core, _history
from ._arrays import Array, forces_of, tangential, vector
from ._options import called, keep
from ._result import Result
from ._words import reason_of

if TYPE_CHECKING:
    from ._options import Callback
    from ._problem import ContactProblem


class StepperState:
    """The state of a `Stepper` at a call of `Stepper.save`; live, as the stepper itself: it does not pickle."""

    _stepper: Stepper
    _core: Any
    _ends: tuple[Any, ...]
    _time: float

    def __init__(self, *_: object, **__: object) -> None:
        raise TypeError("a StepperState is made by `Stepper.save`")

    @classmethod
    def _of(cls, stepper: Stepper, core: Any, ends: tuple[Any, ...]) -> StepperState:
        self = cls.__new__(cls)
        self._stepper, self._core, self._ends, self._time = stepper, core, ends, stepper.t
        return self

    def __repr__(self) -> str:
        return f"<StepperState at t = {self._time:g} s>"

    def __reduce__(self) -> Any:
        raise TypeError("a StepperState is live, as its stepper is: it is neither copied nor pickled")


class Stepper:
    """A history in single increments, each from the end of the last one that converged; made by `ContactProblem.stepper`.

    It analyses the matrix once, or condenses the body once; `work` counts the factorisations of the equations. An increment that did not
    converge may be tried again, to an earlier time or under another load; one that did is taken back by `restore`.

    Attributes
    ----------
    problem : ContactProblem
        The problem.
    work : dict
        Symbolic "analyses" and numerical "factorizations" so far.

    Notes
    -----
    A stepper is live and does not pickle: it has factors, and perhaps a linear solver of yours.

    Examples
    --------
    >>> import numpy as np, stickslip as ss
    >>> problem = ss.ContactProblem(np.diag([2e6, 1e6]), [[0, -1]], [[1, 0]], mu=0.3)
    >>> stepper = problem.stepper()
    >>> for push in (0.0, 40.0):
    ...     result = stepper.step([push, -100.0]).check()
    >>> stepper
    <Stepper at t = 2 s of <ContactProblem 2 displacements, 1 contact node, 1 tangent>>
    >>> float(result.p_t[0, 0, 0])
    30.0
    """

    problem: ContactProblem
    work: dict[str, int]
    _core: _core.Stepper
    _linear: object
    _force: Array
    _gap: Array
    _drift: Array
    _mu: Array
    #: The last increment that converged: its end, and slip and normal forces there.
    _last: tuple[float, Array, Array] | None

    def __init__(self, *_: object, **__: object) -> None:
        raise TypeError("a Stepper is made by `ContactProblem.stepper`, such as problem.stepper(gap=1e-5)")

    @classmethod
    def _of(cls, problem: ContactProblem, gap: ArrayLike, options: dict[str, Any], linear: object) -> Stepper:
        self = cls.__new__(cls)
        self.problem, self.work = problem, {"analyses": 0, "factorizations": 0}
        self._core, self._linear = _core.Stepper(problem._core, options, linear), linear
        self._force, self._gap = np.zeros(problem.n_u), vector("gap", gap, problem.n_c)
        self._drift, self._mu = np.zeros((problem.n_c, problem.tangents)), problem.mu
        self._last = None
        return self

    @property
    def t(self) -> float:
        """The end of the last increment that converged, s."""
        return self._core.time

    def step(
        self, force: ArrayLike, *, t: float | None = None, gap: ArrayLike | None = None, drift: ArrayLike | None = None,
        mu: ArrayLike | None = None, keep_u: str = "all", callback: Callback | None = None,
    ) -> Result:
        """Goes on by an increment; between its ends loads, gaps and obstacles change evenly.

        Parameters
        ----------
        force : (n_u,)
            Nodal forces at its end, N.
        t : float, optional
            Its end, s, above `t`; 1 s later without it (`ContactProblem.solve` divides 1 s).
        gap : float or (n_c,), optional
            Gaps at its end, m; as they were without it.
        drift : float, (n_c,) or (n_c, d), optional
            How far the obstacle has moved past each node, m, counted from the beginning; as it was without it.
        mu : float or (n_c,), optional
            Friction coefficients at its end where they change; as they were without it.
        keep_u : "all" or "none"
            Whether the result has u.
        callback : callable, optional
            As that of `ContactProblem.solve`; if it raises, the stepper has not moved.

        Returns
        -------
        Result
            With this increment alone. Where it did not converge the stepper has not moved.

        Raises
        ------
        ValueError
            An argument, which is named.

        Examples
        --------
        The obstacle moves and drags the mass along, until friction gives way:

        >>> import numpy as np, stickslip as ss
        >>> problem = ss.ContactProblem(np.diag([2e6, 1e6]), [[0, -1]], [[1, 0]], mu=0.3)
        >>> stepper = problem.stepper()
        >>> [float(stepper.step([0.0, -100.0], drift=[drift]).p_t[0, 0, 0].round(9)) for drift in (0.0, 1e-5, 2e-5)]
        [0.0, -20.0, -30.0]
        """
        n_c, d = self.problem.n_c, self.problem.tangents
        begun = self.t
        if t is not None and not isinstance(t, Real):
            raise TypeError(f"t is {t!r}, expected a number")
        end = begun + 1.0 if t is None else float(t)
        if not (np.isfinite(end) and end > begun):
            raise ValueError(f"t is {end:g}, but the last increment ended at {begun:g}")
        new_force = forces_of("force", force, self.problem.n_u)
        new_gap = self._gap if gap is None else vector("gap", gap, n_c)
        new_drift = self._drift if drift is None else tangential("drift", drift if np.ndim(drift) else np.full((n_c, d), drift), n_c, d)
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
            "mu": _history.friction(self.problem, np.stack([self._mu, rows][1 - first :])),
        }
        called(callback)
        raw = self._core.step(tables, keep(keep_u, 1), callback)
        self.work = {name: raw[name] for name in self.work}
        # The core counts increments from the beginning.
        raw["kept"] = [1 for _ in raw["kept"]]
        if self._core.time > begun:
            self._force, self._gap, self._drift, self._mu = new_force, new_gap, new_drift, rows
        moved = [new_drift[None, :, k] for k in range(d)]
        result = Result._of(raw, self.problem, reason=reason_of(raw), linear=self._linear, drift=moved)
        result.__dict__["_begun"] = self._last
        if self._core.time > begun:
            self._last = self._core.time, result.slip[-1], result.p_n[-1]
        return result._told()

    def save(self) -> StepperState:
        """The state of the stepper, for `restore`: an implicit coupling takes back an increment and solves it again.

        Returns
        -------
        StepperState
            It stays valid, so that one can return to it as often as needed.

        Examples
        --------
        A spring of 2e6 N/m pulls at the mass with the displacement that comes out:

        >>> import numpy as np, stickslip as ss
        >>> problem = ss.ContactProblem(np.diag([2e6, 1e6]), [[0, -1]], [[1, 0]], mu=0.3)
        >>> stepper = problem.stepper()
        >>> before, x, steps = stepper.save(), 0.0, 0
        >>> while True:
        ...     result = stepper.step([200.0 - 2e6 * x, -100.0])
        ...     steps += 1
        ...     if abs(result.u[0, 0] - x) < 1e-12:
        ...         break
        ...     x = 0.5 * (x + result.u[0, 0])
        ...     stepper.restore(before)
        >>> stepper.t, bool(np.isclose(x, (200.0 - 30.0) / 4e6))
        (1.0, True)
        """
        return StepperState._of(self, self._core.save(), (self._force, self._gap, self._drift, self._mu, self._last))

    def restore(self, state: StepperState) -> None:
        """Goes back to where `save` was called. The next increment is what it would have been there.

        Parameters
        ----------
        state : StepperState
            Of this stepper.

        Raises
        ------
        ValueError
            The state is that of another stepper.
        """
        if not isinstance(state, StepperState):
            raise TypeError(f"state: a StepperState from `save` expected, {type(state).__name__} found")
        if state._stepper is not self:
            raise ValueError("state is that of another stepper")
        self._core.restore(state._core)
        self._force, self._gap, self._drift, self._mu, self._last = state._ends

    def __reduce__(self) -> Any:
        raise TypeError("a Stepper is live: it is neither copied nor pickled; `save` and `restore` go back to an increment")

    def __repr__(self) -> str:
        return f"<Stepper at t = {self.t:g} s of {self.problem!r}>"
