"""Citations."""

from __future__ import annotations

from ._core import VERSION
from ._result import Result

_PAPER = (
    "P. W. Christensen, A. Klarbring, J. S. Pang, N. Strömberg: Formulation and comparison of algorithms for "
    "frictional contact problems. Int. J. Numer. Meth. Engng 42 (1998) 145-173."
)


def cite(result: Result | None = None) -> str:
    """Citations of a text that uses results: the software, and the paper behind equations and methods.

    Parameters
    ----------
    result : Result, optional
        The result that the text uses; its method is named.

    Returns
    -------
    str
        Two lines.

    Examples
    --------
    >>> import stickslip as ss
    >>> result = ss.run(ss.Scene.example("block"), {"mesh.elements": [20, 10]})
    >>> print(ss.cite(result).splitlines()[1][:40])
    Algorithm BN: P. W. Christensen, A. Klar
    """
    if result is not None and not isinstance(result, Result):
        raise TypeError(f"result: a Result expected, {type(result).__name__} found")
    software = f"stickslip {VERSION}: quasi-static elastic contact with Coulomb friction."
    method = result.report.get("method") if result is not None else None
    what = {"bn": "Algorithm BN", "ip": "Algorithm IP"}.get(str(method), "equations and error measure")
    return f"{software}\n{what}: {_PAPER}"
