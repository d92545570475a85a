"""Arrays and matrices that come in: checked, and named in what is said of them."""

from __future__ import annotations

from typing import Any, TypeVar

import numpy as np
import scipy.sparse as sp
from numpy.typing import ArrayLike, NDArray

from ._words import counted

Array = NDArray[np.float64]

Kind = TypeVar("Kind")


#: The largest number, that of scenes.
LARGEST = 1e50


def finite(name: str, values: ArrayLike) -> Array:
    """An array of real numbers up to `LARGEST`, of any shape."""
    not_masked(name, values)
    try:
        found = np.asarray(values)
        array = found if found.dtype.kind in "bcSU" else found.astype(np.float64, copy=False)
    except (OverflowError, TypeError, ValueError) as error:
        raise ValueError(f"{name} is no array of numbers: {error}") from None
    if array.dtype.kind == "c":
        raise ValueError(f"{name} is complex")
    if array.dtype.kind in "bSU":
        raise ValueError(f"{name} is no array of numbers: {'a truth value' if array.dtype.kind == 'b' else 'a word'} found")
    _not_huge(name, array)
    return array


def not_masked(name: str, values: Any) -> None:
    parts = values if isinstance(values, (list, tuple)) else (values,)
    if any(isinstance(part, np.ma.MaskedArray) and np.ma.is_masked(part) for part in parts):
        raise ValueError(f"{name} has masked entries, whose values are unknown: fill them, such as by filled(0.0)")


def _not_huge(name: str, array: Array) -> None:
    size = abs(array).max(initial=0.0)
    if not np.isfinite(size):
        raise ValueError(f"{name} is not finite")
    if size > LARGEST:
        number = array.flat[int(abs(array).argmax())]
        raise ValueError(f"{name} has the number {number:g}, but products of numbers beyond {LARGEST:g} overflow")


def rows_or_row(shape: tuple[int, ...]) -> str:
    """The shape of a row for all increments, or of a row for each."""
    return f"{shape[1:]} or {shape}" if len(shape) > 1 else str(shape)


def vector(name: str, values: ArrayLike, length: int) -> Array:
    """A new contiguous, finite vector of that length, of a number or of as many."""
    array = finite(name, values)
    if array.ndim > 1 or (array.ndim == 1 and array.shape != (length,)):
        raise ValueError(f"{name} has the shape {array.shape}, expected {(length,)}")
    return np.array(np.broadcast_to(array, length))


def forces_of(name: str, values: ArrayLike, length: int) -> Array:
    """A vector of nodal forces, which a number is none of: it would act on all displacements at once."""
    if np.ndim(array := finite(name, values)) == 0 and length != 1:
        raise ValueError(f"{name} is a number, expected the shape {(length,)}")
    return vector(name, array, length)


def numbers(name: str, values: ArrayLike, shape: tuple[int, ...]) -> Array:
    """An array of this shape, or what numpy makes one of by repeating it."""
    array = finite(name, values)
    if 0 in array.shape and 0 not in shape:
        raise ValueError(f"{name} is empty, expected the shape {shape}")
    try:
        return np.broadcast_to(array, shape)
    except ValueError:
        raise ValueError(f"{name} has the shape {array.shape}, expected {rows_or_row(shape)}") from None


def tangential(name: str, values: ArrayLike | None, nodes: int, tangents: int) -> Array:
    """New values along the tangents, (n_c, d), of as many in any shape; zeros for None."""
    array = np.zeros((nodes, tangents)) if values is None else finite(name, values)
    if array.size != nodes * tangents:
        raise ValueError(f"{name} has the shape {array.shape}, expected {(nodes, tangents)}")
    return array.reshape(nodes, tangents).copy()


def matrix(name: str, values: Any, kind: Any, shape: tuple[int, int] | None = None) -> Any:
    """A finite sparse matrix of this kind, without repeated entries."""
    not_masked(name, values)
    if np.iscomplexobj(values):
        raise ValueError(f"{name} is complex")
    try:
        values = kind(values, dtype=np.float64, copy=True)
    except (OverflowError, TypeError, ValueError) as error:
        raise ValueError(f"{name} is no matrix: {error}") from None
    if values.ndim != 2 or (shape is not None and values.shape != shape):
        raise ValueError(f"{name} has the shape {values.shape}, expected {shape or 'rows and columns'}")
    values.sum_duplicates()
    _not_huge(name, values.data)
    return values


def read_only(values: Kind) -> Kind:
    """The array or the sparse matrix itself; assignments to it, which would be lost, raise from now on."""
    matrix: Any = values
    if sp.issparse(matrix):
        # Sorted now, since scipy sorts in place.
        matrix.sum_duplicates()
    for array in (matrix.data, matrix.indices, matrix.indptr) if sp.issparse(matrix) else (matrix,):
        array.flags.writeable = False
    return values


def compressed(values: Any) -> tuple[Any, Any, Any]:
    """A matrix as the core takes it."""
    return values.data, values.indices.astype(np.int64), values.indptr.astype(np.int64)


def symmetric(K: Any, check: bool) -> Any:
    """K, whose lower triangle is read; refused where that would be another matrix."""
    above, below = ((part.data != 0).any() for part in (sp.triu(K, 1), sp.tril(K, -1)))
    triangle = above != below
    if triangle and not check:
        return K.T.tocsc() if above else K
    if check:
        off, d = abs(K - K.T).tocoo(), np.sqrt(abs(K.diagonal()))
        off, size = off.data, d[off.row] * d[off.col]
    else:
        # By products with a vector, which cost a small part of a difference of matrices.
        x = np.random.default_rng(0).uniform(1.0, 2.0, K.shape[0])
        off, size = abs(K @ x - K.T @ x), abs(K) @ x
    # Each entry beside its own diagonal entries: one large entry elsewhere does not count.
    with np.errstate(divide="ignore"):
        share = float((off[off > 0] / size[off > 0]).max(initial=0.0))
    if share <= 1e-10:
        return K
    cure = "pass check=False, which takes a triangle" if triangle else "where that is rounding, give (K + K.T) / 2"
    what = "has entries on one side of its diagonal only" if triangle else f"differs from its transpose by {share:.1e} of its entries"
    raise ValueError(f"K is not symmetric: it {what}; {cure}")


def contact_maps(C_n: Any, C_t: Any, n_u: int) -> tuple[list[Any], int]:
    """C_n, C_t and C_o by rows, empty where there is none, and the number of tangents."""
    C_n = matrix("C_n", C_n, sp.csr_array)
    n_c = C_n.shape[0]
    if C_n.shape[1] != n_u:
        turned = "; it seems to be transposed: give C_n.T" if n_c == n_u else ""
        raise ValueError(f"C_n has the shape {C_n.shape}, expected (n_c, {n_u}): a row for each contact node{turned}")
    if len(empty := np.flatnonzero(abs(C_n).sum(axis=1) == 0)):
        raise ValueError(f"C_n: row {empty[0]} is 0, so that no displacement moves this node towards the obstacle; leave the node out")
    # A list of matrices, and no matrix that is written as a list of its rows.
    several = isinstance(C_t, (list, tuple)) and all(sp.issparse(C) or np.ndim(C) == 2 for C in C_t)
    tangents = () if C_t is None else tuple(C_t) if several else (C_t,)
    if len(tangents) > 2:
        raise ValueError(f"C_t has {counted(len(tangents), 'matrix', 'matrices')}, expected one or two")
    names = ("C_t",) if len(tangents) == 1 else ("C_t[0]", "C_t[1]")
    maps = [C_n, *(matrix(name, C, sp.csr_array, (n_c, n_u)) for name, C in zip(names, tangents))]
    return maps + [sp.csr_array((n_c, n_u))] * (3 - len(maps)), len(tangents)
