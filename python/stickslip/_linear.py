"""Linear solvers of one's own: checked where a run fails."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

if TYPE_CHECKING:
    from ._arrays import Array
    from ._options import LinearSolver

#: A direct solver in double precision is far below, and equations with larger residuals are not solved.
_RESIDUAL = 1e-8


class Checked:
    """A `LinearSolver` that keeps its last system and answer."""

    def __init__(self, solver: LinearSolver) -> None:
        self._solver = solver
        self._pattern: tuple[int, NDArray[np.int64], NDArray[np.int64]] | None = None
        self._data: Array = np.zeros(0)
        self._last: tuple[Array, Array, Any] | None = None

    @property
    def name(self) -> str:
        """The name of its class."""
        return type(self._solver).__name__

    def analyze(self, n: int, indptr: NDArray[np.int64], indices: NDArray[np.int64], /) -> object:
        # Copies: what a solver writes into its arrays is its own affair.
        self._pattern, self._last = (n, indptr.copy(), indices.copy()), None
        with self._no_verdict("analyze"):
            return self._solver.analyze(n, indptr, indices)

    @contextlib.contextmanager
    def _no_verdict(self, step: str) -> Iterator[None]:
        """Arithmetic errors of a step that cannot say that the matrix is singular, as those of `factorize` do."""
        try:
            yield
        except ArithmeticError as error:
            raise RuntimeError(f"linear.{step}: {self.name} raised {type(error).__name__}: {error}") from error

    def factorize(self, data: Array, /) -> object:
        self._data = data.copy()
        return self._solver.factorize(data)

    def solve(self, b: Array, /) -> Any:
        right = b.copy()
        with self._no_verdict("solve"):
            x = self._solver.solve(b)
        self._last = (self._data, right, x)
        return x

    def residual(self) -> float:
        """|A x - b| / (|A| |x| + |b|) of the last answer, by largest entries and sums of rows; NaN if it is not finite."""
        if self._pattern is None or self._last is None:
            return 0.0
        (n, indptr, indices), (data, b, x) = self._pattern, self._last
        x = np.asarray(x, dtype=np.float64)
        if not np.isfinite(x).all():
            return float("nan")
        A: Any = sp.csc_array((data, indices, indptr), shape=(n, n))
        size = abs(A).sum(axis=1).max(initial=0.0) * abs(x).max(initial=0.0) + abs(b).max(initial=0.0)
        return float(abs(A @ x - b).max(initial=0.0) / size) if size > 0.0 else 0.0

    def blamed(self, reason: str) -> str:
        """The reason why a run failed, or that of the last answer if that is wrong."""
        residual = self.residual()
        if np.isnan(residual):
            # As is right for a singular matrix, so that the reason stays.
            return f"linear: the last answer of {self.name} is not finite" + (f"; {reason}" if reason else "")
        if residual > _RESIDUAL:
            return f"linear: the last answer of {self.name} is wrong, its relative residual is {residual:.1e}"
        return reason
