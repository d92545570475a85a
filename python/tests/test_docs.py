"""The pages: run from top to bottom, and without outputs in the tree."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

PAGES = sorted((Path(__file__).parents[1] / "docs").glob("*.ipynb"))
#: What a page needs beside the tests.
NEEDS = {"your_mesh": "gmsh", "your_elements": "skfem", "table_ii": "pandas"}


def test_there_are_pages() -> None:
    assert len(PAGES) >= 7


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_pages_have_no_outputs(page: Path) -> None:
    cells = json.loads(page.read_text(encoding="utf-8"))["cells"]
    assert not any(cell.get("outputs") or cell.get("execution_count") for cell in cells)


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
@pytest.mark.filterwarnings("default")
def test_pages_run(page: Path) -> None:
    nbformat, nbclient = pytest.importorskip("nbformat"), pytest.importorskip("nbclient")
    for package in ("ipykernel", "matplotlib", NEEDS.get(page.stem, "json")):
        try:
            __import__(package)
        except (ImportError, OSError) as missing:
            pytest.skip(str(missing))
    notebook = nbformat.read(page, as_version=4)
    nbclient.NotebookClient(notebook, timeout=120, resources={"metadata": {"path": str(page.parent)}}).execute()
    assert any(cell.get("outputs") for cell in notebook.cells)
