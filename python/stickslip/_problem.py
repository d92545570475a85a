"""Contact problems made of matrices, and condensed to their contact displacements."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any, TypeVar, overload

import numpy as np
from numpy.typing import ArrayLike

from . import _core, _derivative, _history, _many
from ._arrays import Array, compressed, contact_maps, finite, forces_of, tangential, vector
from ._matrices import Matrices
from ._options import Callback, Linear, LinearSolver, Method, Setting, called, core_options, keep
from ._result import Result
from ._stepper import Stepper
from ._words import counted, reason_of

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from ._options import IncrementOptions, ManyOptions, Several, SolveOptions

Value = TypeVar("Value")


class ContactProblem(Matrices):
    """One body against rigid obstacles, as matrices.

    K u + C_n' p_n + C_t' p_t = f;  C_n u <= g, p_n >= 0;  |p_t| <= mu p_n, along the slip C_t u - w_t_last.

    g are the gaps, w_t_last the values of C_t u before the increment, ' is the transpose. p_n and p_t act on the obstacle, so that p_t has
    the direction of the slip where a node slips.

    Parameters
    ----------
    K : matrix, (n_u, n_u)
        Stiffness, N/m; symmetric positive semidefinite, sparse or dense.
    C_n : matrix, (n_c, n_u)
        Displacements of the contact nodes towards the obstacle.
    C_t : matrix or pair of matrices, (n_c, n_u), optional
        Displacements along the tangents: a pair in three dimensions, None without friction.
    mu : float or (n_c,)
        Friction coefficients.
    weight : float or (n_c,), optional
        Lengths or areas of the contact nodes, m or m²: for stresses and the setting "paper".
    free_motions : (k, n_u), optional
        A basis of the null space of K: the rigid motions that nothing holds. Without it, it is found from K.
    check : bool
        Whether K is compared with its transpose, entry by entry. With False, it is compared by a product with a vector, and may
        also be a triangle of a symmetric matrix, lower or upper.

    Raises
    ------
    ValueError
        A matrix or an array does not fit the others, is not finite or breaks one of these conditions.

    Notes
    -----
    Problems pickle, and are condensed anew where they arrive.

    Examples
    --------
    A mass on two springs, pressed onto a floor and pushed along it:

    >>> import numpy as np, stickslip as ss
    >>> problem = ss.ContactProblem(np.diag([2e6, 1e6]), [[0, -1]], [[1, 0]], mu=0.3)
    >>> problem
    <ContactProblem 2 displacements, 1 contact node, 1 tangent>
    >>> result = problem.solve([[0.0, -100.0], [40.0, -100.0]]).check()
    >>> result.p_n[:, 0], result.p_t[:, 0, 0]
    (array([100., 100.]), array([ 0., 30.]))
    """

    #: The linear algebra where nobody says which.
    _linear: Linear | None = None

    @classmethod
    def _of(cls, core: _core.Problem, tangents: int) -> ContactProblem:
        self = ContactProblem.__new__(ContactProblem)
        self._core, self.tangents = core, tangents
        return self

    def with_(
        self, *, mu: ArrayLike | None = None, weight: ArrayLike | None = None, C_n: Any = None, C_t: Any = None, K: Any = None,
    ) -> ContactProblem:
        """The same problem with other contact, or another stiffness.

        With the same K it shares K and, while the contact displacements stay, the condensed body: once one of the problems has been
        solved condensed, the others are not condensed anew. Gaps are no part of a problem but of `solve`, so that problems with
        other gaps share all this too.

        Parameters
        ----------
        mu : float or (n_c,), optional
            Friction coefficients.
        weight : float or (n_c,), optional
            Lengths or areas of the contact nodes, m or m².
        C_n : matrix, (n_c, n_u), optional
            Displacements towards the obstacle.
        C_t : matrix or pair of matrices, (n_c, n_u), optional
            Displacements along the tangents.
        K : matrix, (n_u, n_u), optional
            Another stiffness, N/m, as `ContactProblem` takes it; its free motions are found from it.

        Returns
        -------
        ContactProblem
            What is not given stays as it is here.

        Raises
        ------
        ValueError
            An array has another shape, or mu is negative; with another n_c, mu and, if there is one, weight must be given.

        Examples
        --------
        >>> import numpy as np, stickslip as ss
        >>> problem = ss.ContactProblem(np.diag([2e6, 1e6]), [[0, -1]], [[1, 0]], mu=0.3)
        >>> slippery = problem.with_(mu=0.1)
        >>> [float(p.solve([40.0, -100.0]).p_t[0, 0, 0]) for p in (problem, slippery)]
        [30.0, 10.0]
        >>> softer = problem.with_(K=problem.K / 2)
        >>> [float(1e6 * p.solve([40.0, -100.0]).u[0, 0].round(15)) for p in (problem, softer)]
        [5.0, 10.0]
        """
        if K is not None:
            return ContactProblem(
                K, self.C_n if C_n is None else C_n, self.C_t if C_t is None else C_t, self.mu if mu is None else mu,
                weight=self.weight if weight is None else weight,
            )
        if C_n is None and C_t is None:
            coefficients = None if mu is None else vector("mu", mu, self.n_c)
            weights = None if weight is None else vector("weight", weight, self.n_c)
            if coefficients is not None and not self.tangents and coefficients.any():
                raise ValueError("mu is above 0, but the problem has no C_t")
            return ContactProblem._of(self._core.with_parts(None, coefficients, weights), self.tangents)
        maps, tangents = contact_maps(
            self.C_n if C_n is None else C_n, (self.C_t or None) if C_t is None else C_t, self.n_u
        )
        n_c = maps[0].shape[0]
        for name, value, mine in (("mu", mu, self.mu), ("weight", weight, self.weight)):
            if value is None and mine is not None and len(mine) != n_c:
                raise ValueError(f"{name} is of {counted(len(mine), 'contact node')}, but C_n has {counted(n_c, 'row')}: give it too")
        coefficients = self.mu if mu is None else vector("mu", mu, n_c)
        if not tangents and coefficients.any():
            raise ValueError("mu is above 0, but there is no C_t")
        weights = None if weight is None else vector("weight", weight, n_c)
        return ContactProblem._of(self._core.with_parts([compressed(C) for C in maps], coefficients, weights), tangents)

    def solve(
        self, force: ArrayLike, factors: ArrayLike | None = None, *, gap: ArrayLike = 0.0, drift: ArrayLike = 0.0,
        mu: ArrayLike | None = None, t: ArrayLike | None = None, method: Method | None = None, setting: Setting | None = None,
        linear: Linear | LinearSolver | None = None, tolerance: float | None = None, max_iterations: int | None = 200,
        r_factor: float | None = 1.0, keep_u: str | Sequence[int] = "all", callback: Callback | None = None,
    ) -> Result:
        """Solves a history that begins unloaded.

        Parameters
        ----------
        force : (n_u,), (m, n_u) or (loads, n_u)
            Nodal forces, N. Without factors a row for each increment; with factors loads.
        factors : (m,) or (m, loads), optional
            Of the loads at the ends of the increments.
        gap : float, (n_c,) or (m + 1, n_c)
            m; the first row of a table is before the first increment.
        drift : float, (m, n_c) or (m, n_c, d)
            How far the obstacle has moved past each node at the ends, m; (m, 1) of an obstacle that moves as a whole.
        mu : float, (n_c,) or (m, n_c), optional
            Friction coefficients in place of the problem's; of each increment where they change.
        t : (m,), optional
            Ends of the increments, s, increasing from above 0; equal parts of 1 s without them (a `Stepper` takes 1 s for each).
        method : "bn", "ip" or "events"
            Newton's method, the interior point method, or the exact path in the plane; "bn" without it. If rows of
            C_n and C_t are linearly dependent, forces are not unique, and the first two find the smallest.
        setting : "default" or "paper"
            The constants of this library, which is the default, or those of Christensen et al. (1998).
        linear : "auto", "faer", "partial", "condensed", "umfpack" or `LinearSolver`
            Linear algebra; "auto", what suits the sizes, without it. "umfpack" where it is built in.
        tolerance : float, optional
            The largest error of any law, relative; 1e-10 without it.
        max_iterations : int, optional
            Of an increment; 200 for None.
        r_factor : float, optional
            A factor of the parameters r of Newton's method, which are proportional to the stiffness of each node; 1 for None.
        keep_u : "all", "last", "none" or list of int
            Of which increments displacements are kept. One history has room for all; `solve_many` keeps the last.
        callback : callable, optional
            Called with (increment, time, status, iterations, error) once an increment is judged; what it raises comes out.

        Returns
        -------
        Result
            With a `NotConvergedWarning` unless every law holds within the tolerance.

        Raises
        ------
        ValueError, TypeError
            An argument, which is named.

        Examples
        --------
        >>> import numpy as np, stickslip as ss
        >>> problem = ss.ContactProblem(np.diag([2e6, 1e6]), [[0, -1]], [[1, 0]], mu=0.3)
        >>> problem.solve([40.0, -100.0], [0.5, 1.0], mu=[[0.3], [0.2]]).p_t[:, 0, 0]
        array([15., 20.])

        The history of a model has the keywords of this function:

        >>> model = ss.Model(ss.Scene.example("block"), {"mesh.elements": [20, 10]})
        >>> bool(np.allclose(model.problem.solve(**model.history).p_n, model.run().p_n))
        True
        """
        return self._solve(
            _history.tables(self, force, factors, gap, drift, mu, t), single=False, keep_u=keep_u, callback=callback,
            method=method, setting=setting, linear=linear, tolerance=tolerance, max_iterations=max_iterations, r_factor=r_factor
        )

    def _solve(
        self, history: tuple[ContactProblem, dict[str, Any]], *, single: bool, keep_u: str | Sequence[int] = "all",
        callback: Callback | None = None, linear: Linear | LinearSolver | None = None, **options: Any,
    ) -> Result:
        problem, tables = history
        method = options.get("method")
        if method == "events" and tables["mu"] is not None:
            raise ValueError("mu: friction that changes is solved by the methods bn and ip; events follows the path of friction that stays")
        words, algebra = core_options(linear=self._linear if linear is None else linear, **options)
        kept = keep(keep_u, len(tables["times"]))
        called(callback)
        raw = problem._core.run(tables, words, algebra, kept, callback, single)
        return Result._of(raw, problem, reason=reason_of(raw), linear=algebra, drift=tables["drift"])._told()

    def solve_increment(
        self, force: ArrayLike, *, gap: ArrayLike = 0.0, w_t_last: ArrayLike | None = None, **options: Unpack[IncrementOptions]
    ) -> Result:
        """One increment from given tangential displacements, set up anew; for many of them in a row see `stepper`.

        Its path is not known, so that it is neither halved nor divided where a node first touches.

        Parameters
        ----------
        force : (n_u,)
            Nodal forces at its end, N.
        gap : float or (n_c,)
            Gaps at its end, m.
        w_t_last : (n_c,) or (n_c, d), optional
            Tangential displacements at its beginning, m: `slip` of the last `u`.
        **options
            As those of `solve`.

        Returns
        -------
        Result
            With one row.

        Examples
        --------
        >>> import numpy as np, stickslip as ss
        >>> problem = ss.ContactProblem(np.diag([2e6, 1e6]), [[0, -1]], [[1, 0]], mu=0.3)
        >>> problem.solve_increment([10.0, -100.0], w_t_last=[[1e-5]]).p_t
        array([[[-10.]]])
        """
        w = tangential("w_t_last", w_t_last, self.n_c, self.tangents)
        mu = options.pop("mu", None)
        history = _history.tables(self, forces_of("force", force, self.n_u), [1.0], vector("gap", gap, self.n_c), w[None], mu, None)
        return self._solve(history, single=True, **options)

    def derivative(
        self, result: Result, *, force: ArrayLike = 0.0, gap: ArrayLike = 0.0, mu: ArrayLike = 0.0, K: Any = None,
    ) -> _derivative.Derivative:
        """The derivative of a solution to its data, along its contact statuses: for fits and sensitivities.

        The equations of every increment are differentiated, nodes stay open, stick or slip as they are, and what an increment inherits
        from the one before is passed on. Where a status is about to change, the derivative is one of several.

        Parameters
        ----------
        result : Result
            A history of this problem from its beginning, with all displacements, none of whose increments was divided.
        force : (n_u,) or (m, n_u), optional
            The direction in which the data change: nodal forces, N, per unit of what they depend on.
        gap : float, (n_c,) or (m, n_c), optional
            Gaps, m, at the ends of the increments.
        mu : float, (n_c,) or (m, n_c), optional
            Friction coefficients; of nodes without friction they do not count.
        K : matrix, (n_u, n_u), optional
            Stiffness, N/m, symmetric: ``K=problem.K / E`` for Young's modulus E.

        Returns
        -------
        Derivative
            Of `u`, `p_n` and `p_t`, for each increment.

        Raises
        ------
        ValueError
            A result that this is not known of, and a direction of another shape.

        Examples
        --------
        >>> import numpy as np, stickslip as ss
        >>> problem = ss.ContactProblem(np.diag([2e6, 1e6]), [[0, -1]], [[1, 0]], mu=0.3)
        >>> result = problem.solve([[0.0, -100.0], [40.0, -100.0]])
        >>> problem.derivative(result, mu=1.0).p_t[:, 0, 0]
        array([  0., 100.])

        Newton's method for the friction at which the mass moves by 2 µm:

        >>> mu = 0.3
        >>> for _ in range(3):
        ...     body = problem.with_(mu=mu)
        ...     result = body.solve([[0.0, -100.0], [40.0, -100.0]])
        ...     mu -= (result.u[1, 0] - 2e-6) / body.derivative(result, mu=1.0).u[1, 0]
        >>> round(float(mu), 9)
        0.36
        """
        return _derivative.of(self, result, force, gap, mu, K)

    @overload
    def solve_many(
        self, force: ArrayLike | None = None, factors: ArrayLike | None = None, *, reduce: None = None, **options: Unpack[ManyOptions]
    ) -> _many.Results: ...

    @overload
    def solve_many(
        self, force: ArrayLike | None = None, factors: ArrayLike | None = None, *, reduce: Callable[[Result], Value],
        **options: Unpack[ManyOptions],
    ) -> list[Value]: ...

    def solve_many(
        self, force: ArrayLike | None = None, factors: ArrayLike | None = None, *, forces: Several | None = None,
        gaps: Several | None = None, mus: Several | None = None, gap: ArrayLike = 0.0,
        drift: ArrayLike = 0.0, t: ArrayLike | None = None, reduce: Callable[[Result], Any] | None = None,
        keep_u: str | Sequence[int] = "last", workers: int | None = None, progress: bool = False, **options: Unpack[SolveOptions],
    ) -> Any:
        """Solves many histories of this body side by side: parameter studies, random fields, fits.

        The body is condensed once, and each history is computed in one thread, without the lock of the interpreter. For many
        samples the cheapest is `condense` and `solve_many` of the condensed problem, which leaves the interior out: `lift` gives
        the displacements of the samples that need them.

        Parameters
        ----------
        forces, gaps, mus : sequences of N, optional
            What differs: the `force`, `gap` and `mu` of each history, each as `solve` takes it; of a table or an array a row for each.
        force, factors, gap, drift, t
            What is the same for all, as `solve` takes it.
        reduce : callable, optional
            A function of a `Result`, called in this thread once a history is done. Its values are kept in place of the results.
            `Result.converged` tells it whether the history failed. What it raises ends the work and comes out.
        keep_u : "last", "all", "none" or list of int
            Of which increments displacements are kept. All of many histories may fill the memory; `solve` keeps all of one.
        workers : int, optional
            So many histories at a time; as many as there are processors without it.
        progress : bool
            Whether tqdm shows a bar.
        **options
            As those of `solve`; `linear` is a word.

        Returns
        -------
        Results
            A list of `Result`, in the order of the input. One that fails has its status and reason, and the others stay. With
            `reduce` a list of its values.

        Raises
        ------
        ValueError
            An argument; nothing is computed then. The entry of a sequence is named, such as ``mus[3]``.

        Examples
        --------
        >>> import numpy as np, stickslip as ss
        >>> problem = ss.ContactProblem(np.diag([2e6, 1e6]), [[0, -1]], [[1, 0]], mu=0.3)
        >>> results = problem.solve_many([40.0, -100.0], mus=[0.1, 0.2, 0.3])
        >>> results
        <Results of 3 histories, all converged>
        >>> results.stack("p_t")[:, 0, 0, 0]
        array([10., 20., 30.])
        >>> problem.solve_many([40.0, -100.0], mus=[0.1, 0.2], reduce=lambda result: float(result.p_t.sum()))
        [10.0, 20.0]
        """
        return _many.solve(
            self, (force, factors, gap, drift, t), {"forces": forces, "gaps": gaps, "mus": mus}, reduce, keep_u, workers,
            progress, dict(options),
        )

    def stepper(
        self, *, gap: ArrayLike = 0.0, method: Method | None = None, setting: Setting | None = None,
        linear: Linear | LinearSolver | None = None, tolerance: float | None = None, max_iterations: int | None = 200,
        r_factor: float | None = 1.0,
    ) -> Stepper:
        """A history whose rest nobody knows yet: for time loops of one's own, and couplings.

        Parameters
        ----------
        gap : float or (n_c,)
            Before the first increment, m.
        method : "bn" or "ip"
            "bn" without it.
        setting, linear, tolerance, max_iterations, r_factor
            As in `solve`.

        Returns
        -------
        Stepper

        Examples
        --------
        >>> import numpy as np, stickslip as ss
        >>> problem = ss.ContactProblem(np.diag([2e6, 1e6]), [[0, -1]], [[1, 0]], mu=0.3)
        >>> stepper = problem.stepper()
        >>> [float(stepper.step([x, -100.0]).p_t[0, 0, 0]) for x in (0.0, 40.0, 0.0)]
        [0.0, 30.0, -10.0]
        """
        options, algebra = core_options(
            method=method, setting=setting, linear=self._linear if linear is None else linear, tolerance=tolerance, max_iterations=max_iterations, r_factor=r_factor
        )
        return Stepper._of(self, gap, options, algebra)

    def condense(self) -> CondensedProblem:
        """The problem in the contact displacements alone, by the library's own static condensation.

        Its K is dense, the Schur complement of this one, and its displacements are those that contact forces act on.

        Returns
        -------
        CondensedProblem
            With `reduce` for forces and `lift` for displacements.

        Raises
        ------
        ValueError
            A part of the body can move while its contact nodes are clamped.

        Examples
        --------
        >>> import numpy as np, stickslip as ss
        >>> K = np.array([[2.0, -1.0, 0.0], [-1.0, 2.0, 0.0], [0.0, 0.0, 1.0]])
        >>> problem = ss.ContactProblem(K, [[0, -1, 0]], [[0, 0, 1]], mu=0.3)
        >>> small = problem.condense()
        >>> small.K.toarray()
        array([[1.5, 0. ],
               [0. , 1. ]])
        >>> force = np.array([-1.0, 0.0, 1.0])
        >>> result = small.solve(small.reduce(force))
        >>> bool(np.allclose(small.lift(result.u[0], force), problem.solve(force).u[0]))
        True
        """
        return CondensedProblem._condensed(self)


class CondensedProblem(ContactProblem):
    """The problem in the contact displacements u_c of a body; made by `ContactProblem.condense`.

    S u_c + C_n' p_n + C_t' p_t = f_s, where S = K_cc - K_cr K_rr^-1 K_rc and f_s = f_c - K_cr K_rr^-1 f_r;
    c are the contact displacements, r the others. It is solved as any problem, with forces f_s that `reduce` computes; `lift` gives all displacements back.

    Attributes
    ----------
    whole : ContactProblem
        The problem that was condensed.

    Notes
    -----
    ``strain_energy`` of its records is u_c' S u_c / 2, that of the condensed body. Forces off the contact nodes add
    f_r' K_rr^-1 f_r / 2 in the whole body: the whole is ``u @ small.whole.K @ u / 2`` of the u that `lift` gives.

    It pickles as the whole problem, and is condensed anew where it arrives.

    Examples
    --------
    >>> import numpy as np, stickslip as ss
    >>> K = np.array([[2.0, -1.0, 0.0], [-1.0, 2.0, 0.0], [0.0, 0.0, 1.0]])
    >>> small = ss.ContactProblem(K, [[0, -1, 0]], [[0, 0, 1]], mu=0.3).condense()
    >>> small
    <CondensedProblem 2 displacements, 1 contact node, 1 tangent>
    >>> small.reduce([-1.0, 0.0, 1.0])
    array([-0.5,  1. ])
    """

    # Its K is dense, and its contact displacements are all that it has.
    _linear: Linear | None = "condensed"

    whole: ContactProblem
    _body: _core.CondensedBody

    def __init__(self, *_: object, **__: object) -> None:
        raise TypeError("a CondensedProblem is made by `ContactProblem(K, C_n, C_t, ...).condense()`")

    @classmethod
    def _condensed(cls, whole: ContactProblem, parts: tuple[_core.Problem, _core.CondensedBody] | None = None) -> CondensedProblem:
        self = cls.__new__(cls)
        self._core, self._body = parts or whole._core.condense()
        self.tangents, self.whole = whole.tangents, whole
        return self

    def reduce(self, force: ArrayLike) -> Array:
        """Forces on the whole body as forces on the contact displacements.

        Parameters
        ----------
        force : (n_u,) or (m, n_u)
            Nodal forces on the whole body, N.

        Returns
        -------
        (self.n_u,) or (m, self.n_u) array
            N; as `solve` of this problem takes them.
        """
        rows, shape = self._rows("force", force, self.whole.n_u)
        return self._body.reduce(rows).reshape(*shape, self.n_u)

    def lift(self, u: ArrayLike, force: ArrayLike) -> Array:
        """All displacements of the body.

        Parameters
        ----------
        u : (self.n_u,) or (m, self.n_u)
            Displacements of this problem, m.
        force : (n_u,) or (m, n_u)
            The forces on the whole body that belong to them, N, before `reduce`.

        Returns
        -------
        (n_u,) or (m, n_u) array
            Free displacements of the whole body, m.
        """
        rows, shape = self._rows("u", u, self.n_u)
        forces, of_force = self._rows("force", force, self.whole.n_u)
        if shape != of_force:
            raise ValueError(f"force has {counted(len(forces), 'row')}, but u has {len(rows)}; solve_many keeps the last u only without keep_u=\"all\"")
        return self._body.lift(rows, forces).reshape(*shape, self.whole.n_u)

    @staticmethod
    def _rows(name: str, values: ArrayLike, width: int) -> tuple[Array, tuple[int, ...]]:
        array = finite(name, values)
        if array.ndim not in (1, 2) or array.shape[-1] != width:
            raise ValueError(f"{name} has the shape {array.shape}, expected (..., {width})")
        return np.ascontiguousarray(np.atleast_2d(array)), array.shape[:-1]

    def with_(
        self, *, mu: ArrayLike | None = None, weight: ArrayLike | None = None, C_n: Any = None, C_t: Any = None, K: Any = None,
    ) -> CondensedProblem:
        """As `ContactProblem.with_`, for friction and weights; another body or other maps are condensed to something else."""
        if K is not None or C_n is not None or C_t is not None:
            raise ValueError("K, C_n and C_t decide to what a body is condensed: problem.with_(K=..., C_n=..., C_t=...).condense()")
        parts = super().with_(mu=mu, weight=weight)._core, self._body
        return CondensedProblem._condensed(self.whole.with_(mu=mu, weight=weight), parts)

    def __reduce__(self) -> Any:
        return CondensedProblem._condensed, (self.whole,)
