"""Names that are gone: each is refused by the name that is in its place."""

from __future__ import annotations

import functools
import sys
from collections.abc import Callable
from operator import attrgetter
from typing import Any, NoReturn

#: Attributes of the package and of its classes, and what is in their place.
ATTRIBUTES: dict[str, dict[str, str]] = {
    "": {"errors": "stickslip.measure", "plot": "Result.plot, plot_history and plot_convergence, and Comparison.plot"},
    "Result": {"success": "converged", "load": "stickslip.load(path)"},
    "Errors": {"worst": "law and error"},
    "Verdict": {"holds": "converged", "remark": "reason"},
    "Comparison": {"verdicts": "values()"},
    "Convergence": {"verdict": "status"},
    "Sweep": {"results": "the sweep itself, which is a list of results"},
    "Posed": {"index": "increment"},
    "Model": {"times": "t", "with_increments": 'with_({"time.increments": ...})'},
    "Stepper": {"time": "t"},
    "ContactProblem": {
        "residual": "stickslip.newton.Natural(problem, force).residual", "jacobian": "stickslip.newton.Natural(problem, force).jacobian",
        "to_siconos": "stickslip.siconos.to_siconos(problem, force)", "from_siconos": "stickslip.siconos.from_siconos",
    },
    "newton.Natural": {"K": "problem.K", "C_n": "problem.C_n", "C_t": "problem.C_t"},
    "exchange.Answer": {"solved": "converged", "iterations": "nit"},
}
#: Keywords of functions and methods, and what is in their place.
KEYWORDS: dict[str, dict[str, str]] = {
    "run": {"increments": 'overrides={"time.increments": ...}'},
    "Model.run": {"increments": 'model.with_({"time.increments": ...}).run()'},
    "sweep": {"jobs": "workers"},
    "ContactProblem.solve": {"times": "t"},
    "ContactProblem.solve_many": {"times": "t", "threads": "workers"},
    "Stepper.step": {"time": "t"},
}


class _Gone:
    """An attribute of a class and of its objects that raises."""

    def __init__(self, message: str) -> None:
        self.message = message

    def __get__(self, of: object, kind: object = None) -> NoReturn:
        raise AttributeError(self.message)


def _refusing(function: Callable[..., Any], where: str, names: dict[str, str]) -> Callable[..., Any]:
    @functools.wraps(function)
    def called(*args: Any, **keywords: Any) -> Any:
        for old in names.keys() & keywords.keys():
            raise TypeError(f"{old} of {where} is gone: take {names[old]}")
        return function(*args, **keywords)

    return called


def refuse_old_names() -> None:
    """Makes the package refuse them."""
    package: Any = sys.modules[__package__]

    def of_package(name: str) -> NoReturn:
        new = ATTRIBUTES[""].get(name)
        raise AttributeError(f"module 'stickslip' has no attribute {name!r}" + (f": it is gone, take {new}" if new else ""))

    package.__getattr__ = of_package
    for where, names in list(ATTRIBUTES.items())[1:]:
        kind = attrgetter(where)(package)
        for old, new in names.items():
            setattr(kind, old, _Gone(f"{old} of {where} is gone: take {new}"))
        # The names that an editor offers.
        kind.__dir__ = lambda of, gone=names: [name for name in object.__dir__(of) if name not in gone]
    for where, names in KEYWORDS.items():
        owner, _, name = where.rpartition(".")
        function = _refusing(attrgetter(where)(package), where, names)
        # A function is found by its module, too, such as by pickle.
        for of in [attrgetter(owner)(package)] if owner else [package, sys.modules[function.__module__]]:
            setattr(of, name, function)
