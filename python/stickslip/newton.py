"""The equations of an increment as a nonsmooth system H(z) = 0, z = (u, p_n, p_t): for Newton loops of one's own.

With pi = p_n + r (C_n u - g) and tau = p_t + r (C_t u - w_t_last), node by node:

    K u + C_n' p_n + C_t' p_t - f = 0
    p_n - max(0, pi) = 0
    p_t - (projection of tau on the disk of the radius mu max(0, pi)) = 0

For every r > 0 the zeros are the solutions of the increment. Unknowns p_t stand tangent after tangent.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import ArrayLike, NDArray

if TYPE_CHECKING:
    from ._problem import ContactProblem

Array = NDArray[np.float64]


class Natural:
    """The natural map of one increment.

    Args:
        problem: K, C_n, C_t, mu.
        force: N, (n_u,).
        gap: m, a number or (n_c,).
        w_t_last: tangential displacements before the increment, m, (n_c,) or (n_c, d).
        r: N/m, a number or (n_c,); the stiffness of each contact node without it.
        mu: friction coefficients of this increment where they change, a number or (n_c,).
    """

    def __init__(
        self, problem: ContactProblem, force: ArrayLike, *, gap: ArrayLike = 0.0, w_t_last: ArrayLike | None = None,
        r: ArrayLike | None = None, mu: ArrayLike | None = None,
    ) -> None:
        from ._problem import vector

        n_c, d = problem.n_c, problem.tangents
        self.problem, self.force, self.gap = problem, vector("force", force, problem.n_u), vector("gap", gap, n_c)
        w = np.zeros((n_c, d)) if w_t_last is None else np.asarray(w_t_last, float).reshape(n_c, d)
        self.w_t_last = w
        self.r = problem._core.contact_stiffness if r is None else vector("r", r, n_c)
        if (self.r <= 0).any():
            raise ValueError("r must be above 0")
        self.mu = problem.mu if mu is None else vector("mu", mu, n_c)
        self.K, self.C_n, self.C_t = problem.K, problem.C_n, problem.C_t

    def _trial(self, u: ArrayLike, p_n: ArrayLike, p_t: ArrayLike | None) -> tuple[Array, Array, Array, Array, Array]:
        from ._problem import vector

        n_c, d = self.problem.n_c, self.problem.tangents
        u, p_n = vector("u", u, self.problem.n_u), vector("p_n", p_n, n_c)
        p_t = np.zeros((n_c, d)) if p_t is None else np.asarray(p_t, float).reshape(n_c, d)
        pi = p_n + self.r * (self.C_n @ u - self.gap)
        tau = p_t + self.r[:, None] * (self.problem.slip(u) - self.w_t_last)
        return u, p_n, p_t, pi, tau

    def residual(self, u: ArrayLike, p_n: ArrayLike, p_t: ArrayLike | None = None) -> Array:
        """H(z), (n_u + n_c (1 + d),), N."""
        u, p_n, p_t, pi, tau = self._trial(u, p_n, p_t)
        balance = self.K @ u + self.C_n.T @ p_n - self.force
        for d, C in enumerate(self.C_t):
            balance = balance + C.T @ p_t[:, d]
        radius, size = self.mu * np.maximum(pi, 0.0), np.linalg.norm(tau, axis=1)
        shrink = np.where(size > radius, radius / np.where(size > 0, size, 1.0), 1.0)
        return np.concatenate([balance, p_n - np.maximum(pi, 0.0), (p_t - shrink[:, None] * tau).T.ravel()])

    def jacobian(self, u: ArrayLike, p_n: ArrayLike, p_t: ArrayLike | None = None) -> Any:
        """The derivative of the linear piece that holds at z, csc_array."""
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
        rows: list[list[Any]] = [[self.K, self.C_n.T, *[C.T for C in self.C_t]]]
        rows.append([-diagonal(closed * self.r) @ self.C_n, diagonal(1.0 - closed), *[None] * d])
        for a in range(d):
            of_u = -diagonal(turns * along[:, a] * self.r) @ self.C_n
            of_t = []
            for b in range(d):
                share = ratio * (float(a == b) - np.where(slides, along[:, a] * along[:, b], 0.0))
                of_u = of_u - diagonal(share * self.r) @ self.C_t[b]
                of_t.append(diagonal(float(a == b) - share))
            rows.append([of_u, -diagonal(turns * along[:, a]), *of_t])
        return sp.csc_array(sp.bmat(rows, format="csc"))
