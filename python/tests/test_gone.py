"""Names that are gone are refused by the ones that are in their place."""

from __future__ import annotations

import inspect
import pickle
import re
from operator import attrgetter

import numpy as np
import pytest

import stickslip as ss
from stickslip._gone import ATTRIBUTES, KEYWORDS


@pytest.mark.parametrize("where, old, new", [(where, old, new) for where, names in ATTRIBUTES.items() for old, new in names.items()])
def test_an_old_attribute_names_the_new_one(where: str, old: str, new: str) -> None:
    kind = attrgetter(where)(ss) if where else ss
    with pytest.raises(AttributeError, match=f"{old}.* gone.*{re.escape(new)}"):
        getattr(kind, old)
    assert not hasattr(kind, old) and not where or old not in inspect.get_annotations(kind)
    for name in re.findall(r"stickslip\.([\w.]+)", new):
        assert attrgetter(name.removesuffix(".residual").removesuffix(".jacobian"))(ss), "the new name is there"


@pytest.mark.parametrize("where, old, new", [(where, old, new) for where, names in KEYWORDS.items() for old, new in names.items()])
def test_an_old_keyword_names_the_new_one(where: str, old: str, new: str) -> None:
    function = attrgetter(where)(ss)
    with pytest.raises(TypeError, match=f"^{old} of {re.escape(where)} is gone: take {re.escape(new)}$"):
        function(**{old: None})
    parameters = inspect.signature(function).parameters
    assert old not in parameters and (new in parameters or new.partition("=")[0] in parameters or "with_" in new)


def test_objects_refuse_them_as_their_classes_do() -> None:
    problem = ss.ContactProblem(np.diag([2e6, 1e6]), [[0, -1]], [[1, 0]], mu=0.3)
    result = problem.solve([40.0, -100.0])
    for of, old, new in ((result, "success", "converged"), (problem, "residual", "Natural"), (problem.condense(), "jacobian", "Natural")):
        with pytest.raises(AttributeError, match=f"^{old} of .* is gone: take .*{new}"):
            getattr(of, old)
        assert old not in dir(of) and "converged" in dir(result)
    for keep_u, word in ((True, "all"), (False, "none")):
        with pytest.raises(TypeError, match=f"^keep_u is {keep_u}, expected '{word}'"):
            problem.solve([40.0, -100.0], keep_u=keep_u)  # type: ignore[arg-type]
    with pytest.raises(AttributeError, match="^module 'stickslip' has no attribute 'nothing'$"):
        ss.nothing  # type: ignore[attr-defined]


def test_functions_are_found_by_their_modules() -> None:
    assert pickle.loads(pickle.dumps(ss.run)) is ss.run and pickle.loads(pickle.dumps(ss.sweep)) is ss.sweep
