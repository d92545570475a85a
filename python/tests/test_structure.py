"""The floors of the package: no module imports itself by way of others, and functions import optional packages alone."""

from __future__ import annotations

import ast
from pathlib import Path

import stickslip

FILES = {path.stem: ast.parse(path.read_text(encoding="utf-8")) for path in Path(stickslip.__file__).parent.glob("*.py")}
#: What a function may import: packages that need not be there.
OPTIONAL = {"matplotlib", "meshio", "pandas", "pyvista", "siconos", "tqdm", "xarray"}


def imported(node: ast.AST) -> set[str]:
    """The names of what an import imports, those of this package without it."""
    if isinstance(node, ast.ImportFrom):
        here = node.level == 1
        return {node.module or ""} if node.module and here else {name.name for name in node.names} if here else {(node.module or "").split(".")[0]}
    return {name.name.split(".")[0] for name in node.names} if isinstance(node, ast.Import) else set()


def test_functions_import_optional_packages_alone() -> None:
    for name, file in FILES.items():
        inside = [node for of in ast.walk(file) if isinstance(of, ast.FunctionDef) for node in ast.walk(of)]
        assert set().union(*map(imported, inside)) <= OPTIONAL, name


def test_no_module_imports_itself_by_way_of_others() -> None:
    # Imports for types alone stand under `if TYPE_CHECKING`, and none is done.
    below = {name: set().union(*map(imported, file.body)) & FILES.keys() for name, file in FILES.items()}
    while below:
        lowest = {name for name, imports in below.items() if not imports & below.keys()}
        assert lowest, f"a circle among {sorted(below)}"
        below = {name: imports for name, imports in below.items() if name not in lowest}


def test_the_lower_floors_know_no_class_of_the_upper_ones() -> None:
    for name in ("_errors", "_fields", "_plot"):
        imports = set().union(*map(imported, ast.walk(FILES[name])))
        assert not imports & {"_compare", "_judge", "_problem", "_result", "_scene"}, name
