"""The page of a run, report.html, in the same browser: `make book-test`. The program is STICKSLIP_PROGRAM, or that of target/."""

import os
import subprocess
from pathlib import Path

import pytest
from conftest import DESK, PHONE, PICTURES, ROOT

PROGRAMS = [os.environ.get("STICKSLIP_PROGRAM"), ROOT / "target/release/stickslip", ROOT / "target/debug/stickslip"]
SCENES = {"plane": "doc/lap.toml", "space": "data/scenes/cube.toml"}


@pytest.fixture(scope="module", params=SCENES)
def page(request, tmp_path_factory):
    program = next((path for path in PROGRAMS if path and Path(path).exists()), None)
    assert program, "build the program first: cargo build --release"
    out = tmp_path_factory.mktemp(request.param)
    scene = ["--set", 'output.times="all"', "--increments", "4"]
    if request.param == "space":
        scene += ["--set", "mesh.elements=[4,4,4]"]
    subprocess.run([program, "run", SCENES[request.param], *scene, "--out", out], cwd=ROOT, check=True, stdout=subprocess.DEVNULL)
    return out / "report.html"


def test_the_report_is_one_small_file(page):
    text = page.read_text()
    assert len(text) < 5_000_000
    assert "https://" not in text


def test_the_slider_shows_each_increment(page, tab):
    tab.goto(page.as_uri())
    assert tab.inner_text(".verdict").startswith("converged")
    seen = set()
    for k in range(4):
        tab.evaluate("k => { const s = document.querySelector('#state'); s.value = k; s.dispatchEvent(new Event('input')); }", k)
        seen.add((tab.inner_text("#when"), tab.inner_html("#stresses") + tab.inner_html("#surface")))
    assert len({when for when, _ in seen}) == 4 and len({drawn for _, drawn in seen}) >= 3
    assert tab.faults == []
    tab.screenshot(path=PICTURES / f"report_{page.parent.name}.png", full_page=True)


def test_tables_sort_and_histories_change(page, tab):
    tab.goto(page.as_uri())
    tab.select_option("#up", label="friction work so far")
    assert "friction work so far" in tab.inner_html("#curve")
    first = tab.inner_text("#increments tbody tr:first-child td")
    tab.click("#increments th:first-child button")
    assert tab.inner_text("#increments tbody tr:first-child td") != first
    assert tab.faults == []


@pytest.mark.parametrize("size", [DESK, PHONE], ids=["desk", "phone"])
def test_nothing_is_wider_than_the_screen(page, browser, size):
    for scheme in ["light", "dark"]:
        context = browser.new_context(viewport=size, color_scheme=scheme)
        tab = context.new_page()
        tab.goto(page.as_uri())
        assert tab.evaluate("document.documentElement.scrollWidth") <= size["width"]
        paper = tab.evaluate("getComputedStyle(document.body).backgroundColor")
        assert (paper == "rgb(255, 255, 255)") == (scheme == "light")
        context.close()


def test_it_prints(page, tab, tmp_path):
    tab.goto(page.as_uri())
    tab.pdf(path=tmp_path / "report.pdf")
    assert (tmp_path / "report.pdf").stat().st_size > 10_000
