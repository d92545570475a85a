"""The examples of all docstrings run, and public names say what each parameter is."""

from __future__ import annotations

import doctest
import importlib
import inspect
import pkgutil
import re
from collections.abc import Iterator
from typing import Any

import pytest

import stickslip

#: Every module of the package that is Python.
MODULES = sorted(module.name for module in pkgutil.iter_modules(stickslip.__path__) if module.name not in ("_core", "__main__"))

#: Those whose public names say what each parameter is.
DOCUMENTED = ("_cite", "_errors", "_fields", "_result", "_scene", "_sweep", "builder", "exchange", "mesh")


@pytest.mark.parametrize("name", MODULES)
def test_examples_of_docstrings_run(name: str) -> None:
    module = importlib.import_module(f"stickslip.{name}")
    finder, runner = doctest.DocTestFinder(), doctest.DocTestRunner(optionflags=doctest.NORMALIZE_WHITESPACE | doctest.ELLIPSIS)
    said: list[str] = []
    for test in finder.find(module):
        runner.run(test, out=said.append)
    assert not runner.summarize(verbose=False).failed, "".join(said)


def public(module: Any) -> Iterator[tuple[str, Any]]:
    """The public functions, classes and methods that a module defines."""
    for name, thing in vars(module).items():
        if name.startswith("_") or getattr(thing, "__module__", None) != module.__name__:
            continue
        if inspect.isfunction(thing):
            yield name, thing
        elif inspect.isclass(thing):
            yield name, thing
            for member, of in vars(thing).items():
                of = of.__func__ if isinstance(of, (classmethod, staticmethod)) else of
                if not member.startswith("_") and (inspect.isfunction(of) or isinstance(of, property)):
                    yield f"{name}.{member}", of


@pytest.mark.parametrize("name", DOCUMENTED)
def test_public_names_say_what_their_parameters_are(name: str) -> None:
    for where, thing in public(importlib.import_module(f"stickslip.{name}")):
        text = inspect.getdoc(thing) or ""
        assert text, f"{where} has no docstring"
        if not inspect.isfunction(thing):
            continue
        parameters = [p for p in inspect.signature(thing).parameters if p not in ("self", "cls") and not p.startswith("_")]
        listed = re.findall(r"^(\*{0,2}\w+(?:, \w+)*)(?: :.*)?$", text.partition("Parameters\n----------\n")[2].partition("\n\n")[0], re.M)
        found = {one.strip("* ") for line in listed for one in line.split(",")}
        assert set(parameters) - {"keys"} <= found or not parameters, f"{where}: {set(parameters) - found} without a description"


@pytest.mark.parametrize("name", MODULES)
def test_docstrings_begin_with_a_noun_or_a_verb(name: str) -> None:
    module = importlib.import_module(f"stickslip.{name}")
    texts = {name: module.__doc__ or ""} | {test.name: test.docstring for test in doctest.DocTestFinder(exclude_empty=False).find(module)}
    first = {where: text.split(maxsplit=1)[0] for where, text in texts.items() if text.strip()}
    assert not {where for where, word in first.items() if word in ("What", "Whatever", "Whether", "Which", "Where", "Why", "How")}
