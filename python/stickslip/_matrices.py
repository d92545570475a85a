"""The matrices of a contact problem."""

from __future__ import annotations

from typing import Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import ArrayLike
from scipy.sparse.linalg import splu

from . import _core
from ._arrays import Array, compressed, contact_maps, finite, matrix, read_only, symmetric, vector
from ._words import counted


class Matrices:
    """The parts of a `ContactProblem`, without the solvers.

    Matrices and arrays are read-only, and copies of them are not: ``problem.K.copy()``.

    Attributes
    ----------
    tangents : int
        The number d of tangents.
    """

    tangents: int
    _core: _core.Problem

    def __init__(
        self, K: Any, C_n: Any, C_t: Any = None, mu: ArrayLike = 0.0, *, weight: ArrayLike | None = None,
        free_motions: ArrayLike | None = None, check: bool = True,
    ) -> None:
        K = matrix("K", K, sp.csc_array)
        n = K.shape[0]
        if K.shape != (n, n):
            raise ValueError(f"K has the shape {K.shape}, which is not square")
        K = symmetric(K, check)
        maps, tangents = contact_maps(C_n, C_t, n)
        n_c = maps[0].shape[0]
        free: Array | None = None
        if free_motions is not None:
            free = np.atleast_2d(finite("free_motions", free_motions))
            free = np.zeros((0, n)) if free.size == 0 else np.ascontiguousarray(free)
            if free.ndim != 2 or free.shape[1] != n:
                raise ValueError(f"free_motions has the shape {free.shape}, expected (k, {n})")
        coefficients = vector("mu", mu, n_c)
        if not tangents and coefficients.any():
            raise ValueError("C_t is missing, but mu is above 0: give C_t, or mu = 0 for contact without friction")
        weights = None if weight is None else vector("weight", weight, n_c)
        lower = matrix("K", sp.tril(K, format="csc"), sp.csc_array)
        self.tangents = tangents
        self._core = _core.Problem(n, compressed(lower), [compressed(C) for C in maps], coefficients, weights, free)

    @property
    def n_u(self) -> int:
        """The number of free displacements."""
        return self._core.n_u

    @property
    def n_c(self) -> int:
        """The number of contact nodes."""
        return self._core.n_c

    @property
    def mu(self) -> Array:
        """Friction coefficients, (n_c,); `with_` gives the body others."""
        return read_only(self._core.mu)

    @property
    def weight(self) -> Array | None:
        """Lengths or areas of the contact nodes, m or m², (n_c,), if they are known."""
        weight = self._core.weight
        return None if weight is None else read_only(weight)

    @property
    def free_motions(self) -> Array:
        """A basis of the null space of K, (k, n_u)."""
        return read_only(np.array(self._core.free_motions()).reshape(-1, self.n_u))

    @property
    def K(self) -> Any:
        """The stiffness, csc_array, (n_u, n_u), N/m."""
        lower = sp.csc_array(self._core.lower(), shape=(self.n_u, self.n_u))
        return read_only((lower + sp.tril(lower, -1, format="csc").T).tocsc())

    @property
    def C_n(self) -> Any:
        """Displacements towards the obstacle, csr_array, (n_c, n_u)."""
        return read_only(sp.csr_array(self._core.map(0), shape=(self.n_c, self.n_u)))

    @property
    def C_t(self) -> tuple[Any, ...]:
        """Displacements along each tangent, csr_array, (n_c, n_u).

        A tuple of one in the plane and of two in space, since a sparse array has no third axis; `ContactProblem` takes it as it is.

        Examples
        --------
        >>> import numpy as np, stickslip as ss
        >>> problem = ss.ContactProblem(np.eye(2), [[0, -1]], [[1, 0]], mu=0.3)
        >>> p_t = np.array([[2.0]])
        >>> sum(C.T @ p_t[:, k] for k, C in enumerate(problem.C_t))
        array([2., 0.])
        """
        return tuple(read_only(sp.csr_array(self._core.map(1 + d), shape=(self.n_c, self.n_u))) for d in range(self.tangents))

    def __reduce__(self) -> Any:
        return _restored, (type(self), self.K, self.C_n, self.C_t, self.mu, self.weight, self.free_motions)

    def __repr__(self) -> str:
        counts = ((self.n_u, "displacement"), (self.n_c, "contact node"), (self.tangents, "tangent"))
        return f"<{type(self).__name__} " + ", ".join(counted(n, what) for n, what in counts) + ">"

    def slip(self, u: ArrayLike) -> Array:
        """Tangential displacements C_t u, without the motion of the obstacle; `Result.slip` is less this motion.

        Parameters
        ----------
        u : (n_u,)
            Free displacements, m.

        Returns
        -------
        (n_c, d) array
            m.

        Examples
        --------
        >>> import numpy as np, stickslip as ss
        >>> ss.ContactProblem(np.eye(2), [[0, -1]], [[1, 0]], 0.3).slip([2.0, 3.0])
        array([[2.]])
        """
        u = vector("u", u, self.n_u)
        return np.stack([C @ u for C in self.C_t], axis=-1) if self.tangents else np.zeros((self.n_c, 0))

    def compliance(self) -> tuple[Array, Any]:
        """The compliance of the contact displacements: w = C K^-1 f - W p, for solvers that have p alone as their unknowns.

        Returns
        -------
        W : (n, n) array
            m/N, with n = n_c (1 + d). Rows 0, 1 (, 2) are the normal and the tangents of node 0, and so on.
        C : (n, n_u) csr_array
            C_n and C_t in this order.

        Raises
        ------
        ValueError
            K is singular.

        Examples
        --------
        >>> import numpy as np, stickslip as ss
        >>> W, C = ss.ContactProblem(np.diag([2.0, 4.0]), [[0, -1]], [[1, 0]], mu=0.3).compliance()
        >>> W
        array([[0.25, 0.  ],
               [0.  , 0.5 ]])
        """
        if len(self.free_motions):
            raise ValueError("K is singular: the body has free motions, and no compliance")
        maps = [self.C_n, *self.C_t]
        order = np.arange(len(maps) * self.n_c).reshape(len(maps), -1).T.ravel()
        C: Any = sp.csr_array(sp.vstack(maps, format="csr"))[order]
        return C @ splu(self.K).solve(C.T.toarray()), C


def _restored(kind: Any, K: Any, C_n: Any, C_t: Any, mu: Any, weight: Any, free_motions: Any) -> Any:
    return kind(K, C_n, C_t, mu, weight=weight, free_motions=free_motions, check=False)
