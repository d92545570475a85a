"""Problems in the files of other programs: FCLIB (HDF5) and the text of Siconos.

`Result.write_fclib` writes them. Rows of u and r follow each other contact by contact, the normal first, with the signs of
Siconos; `stickslip.siconos` has both sides in one table.
"""

from __future__ import annotations

import json
import os
from typing import Any, NamedTuple

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from . import _core, siconos
from ._judge import Posed
from ._options import path_of
from ._words import counted

Array = NDArray[np.float64]


class ProblemFile(NamedTuple):
    """The contents of a file of the global form.

    Attributes
    ----------
    title, description : str
        Its name and its origin; empty without.
    posed : Posed
        The increment: problem, force, gap, w_t_last, mu.
    solution : tuple of ndarray or None
        (u, p_n, p_t) if the file has one: (n_u,), (n_c,), (n_c, d), with the signs of this module.
    """

    title: str
    description: str
    posed: Posed
    solution: tuple[Array, Array, Array] | None


class Answer(NamedTuple):
    """The answer of `solve`, in the notation of the file.

    Attributes
    ----------
    converged : bool
        Whether every law holds within the tolerance of exchange files.
    v, r, u : ndarray
        Unknowns of the bodies (n,), empty in the local form; contact forces and relative velocities (n_c dimension,).
    errors : dict of str to float
        The violation of each law, without units, and the contact of the worst.
    nit : int
        Iterations of all stages.
    """

    converged: bool
    v: Array
    r: Array
    u: Array
    errors: dict[str, Any]
    nit: int


def read(path: str | os.PathLike[str]) -> ProblemFile:
    """The problem in a file of the global form.

    Parameters
    ----------
    path : str or os.PathLike
        An FCLIB file, or a text of Siconos; its first bytes say which.

    Returns
    -------
    ProblemFile

    Raises
    ------
    FileNotFoundError
        If there is no such file.
    ValueError
        A file without a readable problem; of the local form, which has no stiffness; or whose M is no stiffness.

    Examples
    --------
    >>> import os, tempfile
    >>> import stickslip as ss
    >>> result = ss.run(ss.Scene.example("block"), {"mesh.elements": [20, 10]})
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     result.write_fclib(os.path.join(folder, "block.hdf5"))
    ...     file = ss.exchange.read(os.path.join(folder, "block.hdf5"))
    >>> file.title
    'Block on a floor, increment 20 of 20'
    >>> bool((file.solution[1] == result.p_n[-1]).all())
    True
    """
    path = path_of(path)
    raw = _core.read_problem(path)
    if raw["form"] != "global":
        raise ValueError(f"path: {path} has the local form, contact forces alone; stickslip.exchange.solve takes it")
    if raw["constraints"]:
        raise ValueError(f"path: {path} has {counted(raw['constraints'], 'equality constraint')}, which no stiffness has; stickslip.exchange.solve takes it")
    n, columns = len(raw["f"]), len(raw["w"])
    M: Any = sp.csc_array(raw["M"], shape=(n, n))
    H: Any = sp.csc_array(raw["H"], shape=(n, columns))
    posed = siconos.from_siconos(M, H, raw["f"], raw["w"], raw["mu"])
    known = raw["solution"]
    solution = None if known is None else siconos.answer(posed.problem, known["v"], known["r"])
    return ProblemFile(raw["title"] or "", raw["description"] or "", posed, solution)


def solve(path: str | os.PathLike[str]) -> Answer:
    """Solves the problem in a file, of either form, as ``stickslip solve`` does.

    Parameters
    ----------
    path : str or os.PathLike
        An FCLIB file, or a text of Siconos.

    Returns
    -------
    Answer
        The best that was found; ``converged`` says whether it is a solution.

    Raises
    ------
    FileNotFoundError
        If there is no such file.
    ValueError
        A file without a readable problem.

    Examples
    --------
    A unit mass that falls on a floor and slides, as Siconos writes it: dimension, contacts, W, q, mu.

    >>> import os, tempfile
    >>> import stickslip as ss
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = os.path.join(folder, "mass.dat")
    ...     with open(path, "w") as file:
    ...         _ = file.write("2 1  0 2 2  2 2  1 0 0 1  -2 3  0.5")
    ...     answer = ss.exchange.solve(path)
    >>> answer.converged, answer.r.tolist()
    (True, [2.0, -1.0])
    """
    raw = _core.solve_problem(path_of(path))
    return Answer(raw["solved"], raw["v"], raw["r"], raw["u"], json.loads(raw["errors"]), raw["iterations"])
