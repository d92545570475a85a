"""A body condensed to its contact displacements."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from . import _core
from ._arrays import Array, finite
from ._options import Linear
from ._problem import ContactProblem
from ._words import counted


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
    def _condensed(cls, whole: ContactProblem) -> CondensedProblem:
        self = cls.__new__(cls)
        self._core, self._body = whole._core.condense()
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
        self, *, mu: ArrayLike | None = None, weight: ArrayLike | None = None, C_n: Any = None, C_t: Any = None,
    ) -> CondensedProblem:
        """As `ContactProblem.with_`, for friction and weights; other maps have other contact displacements."""
        if C_n is not None or C_t is not None:
            raise ValueError("C_n and C_t decide to what a body is condensed: problem.with_(C_n=..., C_t=...).condense()")
        other = CondensedProblem.__new__(CondensedProblem)
        other._core, other._body = super().with_(mu=mu, weight=weight)._core, self._body
        other.tangents, other.whole = self.tangents, self.whole.with_(mu=mu, weight=weight)
        return other

    def __reduce__(self) -> Any:
        return CondensedProblem._condensed, (self.whole,)
