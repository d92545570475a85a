"""The equations of an increment as a nonsmooth system H(z) = 0, z = (u, p_n, p_t): for Newton loops of one's own.

With pi = p_n + r (C_n u - g) and tau = p_t + r (C_t u - w_t_last), node by node:

    K u + C_n' p_n + C_t' p_t - f = 0
    p_n - max(0, pi) = 0
    p_t - (projection of tau on the disk of the radius mu max(0, pi)) = 0

For every r > 0 the zeros are the solutions of the increment. Unknowns p_t stand tangent after tangent.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import ArrayLike

from ._arrays import Array, forces_of, tangential, vector
from ._problem import ContactProblem


class Natural:
    """The natural map of one increment.

    Parameters
    ----------
    problem : ContactProblem
        K, C_n, C_t, mu.
    force : (n_u,)
        N.
    gap : float or (n_c,)
        m.
    w_t_last : (n_c,) or (n_c, d), optional
        Tangential displacements before the increment, m.
    r : float or (n_c,), optional
        N/m; the stiffness of each contact node without it.
    mu : float or (n_c,), optional
        Friction coefficients of this increment where they change.

    Attributes
    ----------
    problem, force, gap, w_t_last, r, mu
        As given, in full shape.

    Raises
    ------
    ValueError
        An argument of another shape, or r is not above 0.

    Examples
    --------
    Newton's method, which takes three steps here:

    >>> import numpy as np, stickslip as ss
    >>> from scipy.sparse.linalg import spsolve
    >>> from stickslip.newton import Natural
    >>> problem = ss.ContactProblem(np.diag([2e6, 1e6]), [[0, -1]], [[1, 0]], mu=0.3)
    >>> natural, z = Natural(problem, [40.0, -100.0]), np.zeros(4)
    >>> for _ in range(3):
    ...     z = z - spsolve(natural.jacobian(z[:2], z[2:3], z[3:]), natural.residual(z[:2], z[2:3], z[3:]))
    >>> z[2:].round(9)
    array([100.,  30.])
    """

    def __init__(
        self, problem: ContactProblem, force: ArrayLike, *, gap: ArrayLike = 0.0, w_t_last: ArrayLike | None = None,
        r: ArrayLike | None = None, mu: ArrayLike | None = None,
    ) -> None:
        n_c, d = problem.n_c, problem.tangents
        self.problem: ContactProblem = problem
        self.force: Array = forces_of("force", force, problem.n_u)
        self.gap: Array = vector("gap", gap, n_c)
        self.w_t_last: Array = tangential("w_t_last", w_t_last, n_c, d)
        self.r: Array = problem._core.contact_stiffness if r is None else vector("r", r, n_c)
        if (self.r <= 0).any():
            raise ValueError("r is not above 0")
        self.mu: Array = problem.mu if mu is None else vector("mu", mu, n_c)
        self._K, self._C_n, self._C_t = problem.K, problem.C_n, problem.C_t

    def __repr__(self) -> str:
        return f"<Natural map of {self.problem!r}>"

    def _trial(self, u: ArrayLike, p_n: ArrayLike, p_t: ArrayLike | None) -> tuple[Array, Array, Array, Array, Array]:
        n_c, d = self.problem.n_c, self.problem.tangents
        u, p_n = vector("u", u, self.problem.n_u), vector("p_n", p_n, n_c)
        p_t = tangential("p_t", p_t, n_c, d)
        pi = p_n + self.r * (self._C_n @ u - self.gap)
        tau = p_t + self.r[:, None] * (self.problem.slip(u) - self.w_t_last)
        return u, p_n, p_t, pi, tau

    def residual(self, u: ArrayLike, p_n: ArrayLike, p_t: ArrayLike | None = None) -> Array:
        """H(z).

        Parameters
        ----------
        u, p_n, p_t : (n_u,), (n_c,) and (n_c, d)
            Displacements, m, and contact forces, N.

        Returns
        -------
        (n_u + n_c (1 + d),) array
            N: of the nodes' balance, of p_n, and of p_t tangent after tangent.
        """
        u, p_n, p_t, pi, tau = self._trial(u, p_n, p_t)
        balance = self._K @ u + self._C_n.T @ p_n - self.force
        for d, C in enumerate(self._C_t):
            balance = balance + C.T @ p_t[:, d]
        radius, size = self.mu * np.maximum(pi, 0.0), np.linalg.norm(tau, axis=1)
        shrink = np.where(size > radius, radius / np.where(size > 0, size, 1.0), 1.0)
        return np.concatenate([balance, p_n - np.maximum(pi, 0.0), (p_t - shrink[:, None] * tau).T.ravel()])

    def jacobian(self, u: ArrayLike, p_n: ArrayLike, p_t: ArrayLike | None = None) -> Any:
        """The derivative of the linear piece that holds at z.

        Parameters
        ----------
        u, p_n, p_t : (n_u,), (n_c,) and (n_c, d)
            Displacements, m, and contact forces, N.

        Returns
        -------
        csc_array
            Square, in the order of `residual`.
        """
        u, p_n, p_t, pi, tau = self._trial(u, p_n, p_t)
        n_c, d = tau.shape
        closed = (pi > 0).astype(float)
        size = np.linalg.norm(tau, axis=1)
        radius = self.mu * np.maximum(pi, 0.0)
        slides = size > radius
        safe = np.where(size > 0, size, 1.0)
        along, ratio = tau / safe[:, None], np.where(slides, radius / safe, 1.0)

        def diagonal(values: Array) -> Any:
            return sp.csr_array(sp.diags(values))

        turns = self.mu * closed * slides
        rows: list[list[Any]] = [[self._K, self._C_n.T, *[C.T for C in self._C_t]]]
        rows.append([-diagonal(closed * self.r) @ self._C_n, diagonal(1.0 - closed), *[None] * d])
        for a in range(d):
            of_u = -diagonal(turns * along[:, a] * self.r) @ self._C_n
            of_t = []
            for b in range(d):
                share = ratio * (float(a == b) - np.where(slides, along[:, a] * along[:, b], 0.0))
                of_u = of_u - diagonal(share * self.r) @ self._C_t[b]
                of_t.append(diagonal(float(a == b) - share))
            rows.append([of_u, -diagonal(turns * along[:, a]), *of_t])
        return sp.csc_array(sp.bmat(rows, format="csc"))
