"""The pages are in the tree without outputs; `make python-docs` runs them. Examples of docstrings are run here."""

from __future__ import annotations

import doctest
import importlib
import inspect
import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import stickslip as ss

PAGES = sorted((Path(__file__).parents[1] / "docs").glob("*.ipynb"))


def test_there_are_pages() -> None:
    assert len(PAGES) >= 7


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_pages_have_no_outputs(page: Path) -> None:
    cells = json.loads(page.read_text(encoding="utf-8"))["cells"]
    assert not any(cell.get("outputs") or cell.get("execution_count") for cell in cells)


MODULES = ("_options", "_problem", "_matrices", "_many", "_stepper", "_judge", "_compare", "newton", "siconos")


def public(module: str) -> Iterator[tuple[str, Any]]:
    """What the package exports or a public module has: functions, classes and their own methods."""
    found = importlib.import_module(f"stickslip.{module}")
    for name, value in vars(found).items():
        here = getattr(value, "__module__", "") == found.__name__ and (inspect.isclass(value) or inspect.isfunction(value))
        if not here or name.startswith("_") or (module.startswith("_") and getattr(ss, name, None) is not value):
            continue
        yield f"{module}.{name}", value
        for method, inner in vars(value).items() if inspect.isclass(value) else ():
            if not method.startswith("_") and (inspect.isfunction(inner) or isinstance(inner, classmethod)):
                yield f"{module}.{name}.{method}", getattr(value, method)


@pytest.mark.parametrize("module", MODULES)
@pytest.mark.skipif(np.lib.NumpyVersion(np.__version__) < "2.0.0", reason="numbers are shown in another way")
def test_examples_of_docstrings_give_what_they_show(module: str) -> None:
    found = importlib.import_module(f"stickslip.{module}")
    result = doctest.testmod(found, optionflags=doctest.NORMALIZE_WHITESPACE)
    assert result.attempted or module == "_options", "no examples"
    assert not result.failed


@pytest.mark.parametrize("name, value", [item for module in MODULES for item in public(module)], ids=lambda item: item if isinstance(item, str) else "")
def test_public_names_have_docstrings_that_are_complete(name: str, value: Any) -> None:
    text = inspect.getdoc(value) or ""
    assert text
    if "see `stickslip." in text or text.startswith("As `") or name.startswith("_options.LinearSolver."):
        return
    if inspect.isclass(value):
        assert "Examples\n" in text or value is ss.StepperState, "no example"
        return
    parameters = [p for p in inspect.signature(value).parameters if p != "self"]
    if parameters:
        assert "Parameters\n" in text, "no parameters"
        described = text.split("Parameters\n")[1]
        assert not [p for p in parameters if p not in described], "a parameter is not described"
