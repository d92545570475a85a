"""Runs notebooks, and compares what they say with their pages in doc/python: `pages.py [--write] NOTEBOOK...`.

Words must be those of the page, numbers equal to a thousandth; numbers below 1e-6, whose digits are rounding errors, and seconds may differ. With `--write` the pages and their pictures are written in place.
"""

from __future__ import annotations

import argparse
import base64
import contextlib
import io
import os
import re
import runpy
import sys
import warnings
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import nbformat
from nbclient import NotebookClient

HERE = Path(__file__).resolve().parent
PAGES = HERE.parents[1] / "doc/python"
NUMBER = re.compile(r"[-+]?\d+(?:\.\d*)?(?:e[-+]?\d+)?")
SECONDS = re.compile(r"\d+(?:\.\d*)?(?= s\b)")
# Where a warning was raised: in the notebook, by the line that follows.
WARNED = re.compile(r"^\S*/ipykernel_\S*?\.py:\d+: (.*)\n  .*$", re.MULTILINE)

# Pictures are the same files wherever they are drawn by one version of matplotlib.
SETUP = "%config InlineBackend.figure_formats = ['png']\n%config InlineBackend.rc = {'figure.dpi': 110, 'savefig.bbox': None}"


def run(notebook: Path) -> Any:
    """The notebook, executed where it is."""
    book = nbformat.read(notebook, as_version=4)
    book.cells.insert(0, nbformat.v4.new_code_cell(SETUP))
    NotebookClient(book, timeout=1200, resources={"metadata": {"path": str(HERE)}}, extra_arguments=["--log-level=ERROR"]).execute()
    del book.cells[0]
    return book


def fenced(text: str, language: str) -> str:
    return f"```{language}\n{text.rstrip()}\n```"


def table(html: str) -> str:
    """What a notebook shows as HTML, without styles of its own, on one line: a block of Markdown ends at an empty one."""
    html = re.sub(r"<style.*?</style>", "", html, flags=re.DOTALL)
    html = re.sub(r'<table border="1" class="dataframe">', "<table>", html).replace(' style="text-align: right;"', "")
    return '<div class="output">' + re.sub(r"\s*\n\s*", "", html) + "</div>"


def page_of(notebook: Path) -> tuple[str, dict[str, bytes]]:
    """The page of a notebook as Markdown, and its pictures by name."""
    name, parts, pictures = notebook.stem, [], {}
    for cell in run(notebook).cells:
        if cell.cell_type == "markdown":
            # Links are relative to this folder.
            parts.append(cell.source.replace("](../../doc/", "](../"))
            if len(parts) == 1:
                parts.append(f"This page is made of the notebook [{notebook.name}](../../python/docs/{notebook.name}).")
            continue
        parts.append(fenced(re.sub(r"^%.*\n", "", cell.source, flags=re.MULTILINE), "python"))
        for stream in ("stdout", "stderr"):
            said = "".join(output.text for output in cell.outputs if output.get("name") == stream)
            # A result lists its warnings itself.
            listed = stream == "stderr" and any("<p>Warnings:" in output.get("data", {}).get("text/html", "") for output in cell.outputs)
            if said and not listed:
                parts.append(fenced(WARNED.sub(r"\1", said), "text"))
        for output in cell.outputs:
            if output.output_type == "stream":
                continue
            data = output.data
            if "image/png" in data:
                file = f"{name}_{len(pictures) + 1}.png"
                pictures[file] = base64.b64decode(data["image/png"])
                title = parts[0].splitlines()[0].lstrip("# ")
                parts.append(f"![{title}, picture {len(pictures)}](notebooks/{file})")
            elif "text/html" in data:
                parts.append(table(data["text/html"]))
            else:
                parts.append(fenced(data["text/plain"], "text"))
    return "\n\n".join(parts) + "\n", pictures


def alike(found: str, kept: str) -> bool:
    """Whether two pages say the same."""
    found, kept = SECONDS.sub("0", found), SECONDS.sub("0", kept)
    if NUMBER.sub("0", " ".join(found.split())) != NUMBER.sub("0", " ".join(kept.split())):
        return False
    pairs = zip(NUMBER.findall(found), NUMBER.findall(kept), strict=True)
    return all(abs(a - b) <= max(1e-6, 1e-3 * abs(b)) for a, b in ((float(a), float(b)) for a, b in pairs))


def treat(notebook: Path, write: bool) -> str:
    """What is wrong with the page of a notebook."""
    text, pictures = page_of(notebook)
    page = PAGES / f"{notebook.stem}.md"
    if write:
        (PAGES / "notebooks").mkdir(exist_ok=True)
        for old in (PAGES / "notebooks").glob(f"{notebook.stem}_*.png"):
            old.unlink()
        for name, content in pictures.items():
            (PAGES / "notebooks" / name).write_bytes(content)
        (PAGES / f"notebooks/{notebook.stem}.png").write_bytes(thumbnail(pictures[f"{notebook.stem}_1.png"], notebook.stem == "your_mesh"))
        page.write_text(text, encoding="utf-8")
        return ""
    kept = page.read_text(encoding="utf-8") if page.exists() else ""
    if not alike(text, kept):
        (new := HERE.parents[1] / "target/python-docs").mkdir(parents=True, exist_ok=True)
        (new / page.name).write_text(text, encoding="utf-8")
        return f"{page}: not what its notebook says now, which is in {new / page.name}; `make python-docs PAGES=--write` writes it"
    there = {path.name for path in (PAGES / "notebooks").glob(f"{notebook.stem}_*.png")}
    return "" if there == set(pictures) else f"{page}: pictures {sorted(there ^ set(pictures))}"


def thumbnail(picture: bytes, lower: bool) -> bytes:
    """One of the two drawings of a picture, for the gallery: the left one, or the lower one."""
    from PIL import Image

    image = Image.open(io.BytesIO(picture))
    width, height = image.size
    if lower:
        image = image.crop((0, height * 21 // 40, width, height))
    elif 2 * width > 5 * height:
        image = image.crop((0, 0, width // 2, height))
    image.save(out := io.BytesIO(), "png", optimize=True)
    return out.getvalue()


def draw_examples() -> None:
    """A picture of each script of python/examples that has something to show, for the gallery."""
    import matplotlib

    matplotlib.use("agg")
    import stickslip as ss
    from matplotlib import pyplot as plt

    def spring(of: dict[str, Any], ax: Any) -> None:
        x, answer = of["model"].contact_points[:, 0], of["result"]
        ax.plot(x, 1e-3 * answer.p_n[0], ".-", label="normal")
        ax.plot(x, 1e-3 * answer.p_t[0, :, 0], ".-", label="tangential")
        ax.set(xlabel="x, m", ylabel="force of the node, kN/m")
        ax.legend()

    def warm(of: dict[str, Any], ax: Any) -> None:
        model, results, temperature = of["main"]()
        x = model.contact_points[:, 0]
        ax.plot(x, 1e-6 * results[-1].p_n[0] / model.problem.weight, ".-")
        ax.set(xlabel="x, m", ylabel="pressure, MPa")
        other = ax.twinx()
        other.plot(x, temperature, ".-", color="tab:red")
        other.set_ylabel("temperature above the beginning, K", color="tab:red")

    pictures = {
        "builder": lambda of, ax: of["result"].plot(ax=ax),
        "coupling": spring,
        "thermoelastic": warm,
        "own_solver": lambda of, ax: ss.Model(of["block"]).run(linear=of["Scipy"]()).plot_convergence(ax),
    }
    with warnings.catch_warnings(), contextlib.redirect_stdout(io.StringIO()):
        warnings.simplefilter("ignore", ss.AccuracyWarning)
        for name, draw in pictures.items():
            figure, ax = plt.subplots(figsize=(7, 4), layout="constrained")
            draw(runpy.run_path(str(HERE.parent / f"examples/{name}.py")), ax)
            figure.savefig(PAGES / f"notebooks/example_{name}.png", dpi=110)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--write", action="store_true")
    parser.add_argument("notebooks", nargs="*", type=Path, default=sorted(HERE.glob("*.ipynb")))
    chosen = parser.parse_args()
    os.environ |= {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "RAYON_NUM_THREADS": "1", "PYTHONHASHSEED": "0"}
    with ThreadPoolExecutor(2) as pool:
        faults = [fault for fault in pool.map(lambda notebook: treat(notebook, chosen.write), chosen.notebooks) if fault]
    if chosen.write:
        draw_examples()
    sys.exit("\n".join(faults) or None)


if __name__ == "__main__":
    main()
