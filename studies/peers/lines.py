#!/usr/bin/env python3
"""Lines of code for the block by several packages, as this repository has them: without comments, docstrings and empty lines.

    python3 studies/peers/lines.py
"""

import ast
import json
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


def count(text, function=None):
    """The lines of a text, or of one of its functions."""
    nodes = [node for node in ast.walk(ast.parse(text)) if function is None or getattr(node, "name", None) == function]
    within = range(1, len(text.splitlines()) + 1) if function is None else range(nodes[0].lineno, nodes[0].end_lineno + 1)
    told = set()
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, (ast.Module, ast.FunctionDef, ast.ClassDef)) and ast.get_docstring(node):
            told |= set(range(node.body[0].lineno, node.body[0].end_lineno + 1))
    lines = text.splitlines()
    return sum(1 for i in within if i not in told and lines[i - 1].strip() and not lines[i - 1].strip().startswith("#"))


def cells(notebook, *ids):
    """The text of some cells of a notebook."""
    book = json.loads((ROOT / f"python/docs/{notebook}.ipynb").read_text())
    return "\n".join("".join(cell["source"]) for cell in book["cells"] if cell["id"] in ids)


peers = (ROOT / "studies/peers/compare.py").read_text()
rows = [
    ("stickslip, builder and run", count((ROOT / "python/examples/builder.py").read_text())),
    ("stickslip, matrices of scikit-fem: contact and run", count(cells("your_elements", "your_ele-03"))),
    ("scikit-fem, elements and load", count(cells("your_elements", "your_ele-01"))),
    ("GetFEM, its own elements", count((ROOT / "python/examples/getfem_block.py").read_text())),
    ("GetFEM, given matrices", count(peers, "getfem")),
    ("Siconos, given matrices, whole system", count(peers, "siconos_options") + count(peers, "siconos_whole")),
    ("Siconos, given matrices, condensed", count(peers, "siconos_options") + count(peers, "siconos_condensed")),
    ("semismooth Newton method, numpy and SciPy", count((ROOT / "studies/peers/semismooth_newton.py").read_text())),
]
for name, lines in rows:
    print(f"{name:<52}{lines:>4}")
