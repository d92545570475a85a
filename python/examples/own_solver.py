"""A direct solver of one's own: scipy's LU in place of the built-in ones."""

from typing import Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray
from scipy.sparse.linalg import splu

import stickslip as ss


class Scipy:
    """What `stickslip.LinearSolver` asks for."""

    def analyze(self, n: int, indptr: NDArray[np.int64], indices: NDArray[np.int64], /) -> None:
        self.pattern = n, indptr, indices

    def factorize(self, data: NDArray[np.float64], /) -> None:
        n, indptr, indices = self.pattern
        try:
            self.lu: Any = splu(sp.csc_array((data, indices, indptr), shape=(n, n)))
        except RuntimeError as error:
            raise ZeroDivisionError(str(error)) from error

    def solve(self, b: NDArray[np.float64], /) -> NDArray[np.float64]:
        x: NDArray[np.float64] = self.lu.solve(b)
        return x


block = ss.Scene.block([1.0, 1.0], [20, 20]).material(young=210e9, poisson=0.3).support("left", "x", "y")
block = block.contact("bottom", ss.builder.plane(gap=1e-5), friction=0.4).time(end=1.0, increments=10)
block = block.load("top", traction=[0.0, -10e6], history=[[0, 0], [1, 1]])
print(ss.Model(block).run(linear=Scipy()).check())
print(ss.Model(block).run().check())
