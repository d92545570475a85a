"""The page of a run, report.html, in the same browser: `make book-test`. The program is STICKSLIP_PROGRAM, or that of target/."""

import json
import os
import shutil
import subprocess
from pathlib import Path

import pytest
from conftest import DESK, PHONE, PICTURES, ROOT

PROGRAMS = [os.environ.get("STICKSLIP_PROGRAM"), ROOT / "target/release/stickslip", ROOT / "target/debug/stickslip"]
SCENES = {"plane": "doc/lap.toml", "space": "data/scenes/cube.toml"}


def stickslip(*arguments):
    program = next((path for path in PROGRAMS if path and Path(path).exists()), None)
    assert program, "build the program first: cargo build --release"
    subprocess.run([program, *arguments], cwd=ROOT, check=True, stdout=subprocess.DEVNULL)


@pytest.fixture(scope="module", params=SCENES)
def page(request, tmp_path_factory):
    out = tmp_path_factory.mktemp(request.param)
    scene = ["--set", 'output.times="all"', "--increments", "4"]
    if request.param == "space":
        scene += ["--set", "mesh.elements=[4,4,4]", "--set", "output.deformed=true"]
    stickslip("run", SCENES[request.param], *scene, "--out", out)
    return out / "report.html"


@pytest.fixture(scope="module")
def fretting(tmp_path_factory):
    """A closed load cycle in mm and N/mm, with probes whose names differ by a character that is not in file names."""
    out = tmp_path_factory.mktemp("fretting")
    probes = 'output.probe=[{name="top/a", point=[10, 10]}, {name="top a", point=[9, 5]}]'
    stickslip("run", "data/tutorials/fretting.toml", "--set", probes, "--out", out)
    return out


def test_the_report_is_one_small_file(page):
    text = page.read_text()
    assert len(text) < 1_500_000
    assert "https://" not in text


def test_the_slider_shows_each_increment(page, tab):
    tab.goto(page.as_uri())
    assert tab.inner_text(".verdict").startswith("Converged in all 4 increments.")
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


def test_a_drag_zooms_and_a_double_click_shows_all_again(fretting, tab):
    tab.goto((fretting / "report.html").as_uri())
    ticks = tab.locator("#curve > svg > text").all_inner_texts()
    tab.locator("#curve > svg").scroll_into_view_if_needed()
    box = tab.locator("#curve > svg").bounding_box()
    at = lambda x, y: (box["x"] + x * box["width"], box["y"] + y * box["height"])
    tab.mouse.move(*at(0.4, 0.3))
    tab.mouse.down()
    tab.mouse.move(*at(0.7, 0.6))
    tab.mouse.up()
    assert tab.locator("#curve > svg > svg").get_attribute("style") == "overflow:hidden"
    assert tab.locator("#curve > svg > text").all_inner_texts() != ticks
    tab.mouse.dblclick(*at(0.5, 0.5))
    assert tab.locator("#curve > svg > text").all_inner_texts() == ticks
    assert tab.locator("#curve > svg > svg").get_attribute("style") == "overflow:visible"
    assert tab.faults == []


def test_it_prints_no_cut_columns(page, tab, tmp_path):
    tab.goto(page.as_uri())
    tab.pdf(path=tmp_path / "report.pdf")
    assert (tmp_path / "report.pdf").stat().st_size > 10_000
    # A4 without margins of 1 cm.
    tab.set_viewport_size({"width": 718, "height": 1047})
    tab.emulate_media(media="print")
    assert tab.evaluate("document.documentElement.scrollWidth") <= 718
    assert tab.evaluate("[...document.querySelectorAll('table')].every((sheet) => sheet.getBoundingClientRect().right <= 718)")
    assert tab.locator("#warnings details:not([open])").count() == 0


@pytest.mark.parametrize("size", [{"width": 1280, "height": 800}, PHONE], ids=["desk", "phone"])
def test_the_first_screen_has_verdict_numbers_and_picture(page, browser, size):
    tab = browser.new_page(viewport=size)
    tab.goto(page.as_uri())
    words = tab.inner_text("#first")
    assert "largest contact force" in words and "friction in use" in words and "slip" in tab.inner_text(".verdict")
    for place in [".verdict", "#numbers", "#canvas"]:
        box = tab.locator(place).bounding_box()
        assert box["y"] >= 0 and box["y"] + box["height"] <= size["height"], place
    # A pressure that depends on the mesh is not bold, and the mean pressure stands first in its place.
    assert all(words in tab.inner_text("#numbers div:last-child") for words in ["mean pressure", "depends on the mesh"])
    last = "#results tbody tr:last-child td:nth-child(2)"
    assert tab.evaluate("(place) => getComputedStyle(document.querySelector(place)).fontWeight", last) == "400"
    # A warning is one line, and unfolds.
    line = tab.locator("#warnings details").first
    assert line.bounding_box()["height"] < 40
    line.locator("summary").click()
    assert line.bounding_box()["height"] > 40
    tab.close()


def set_slider(tab, selector, value):
    tab.evaluate("([s, v]) => { const e = document.querySelector(s); e.value = v; e.dispatchEvent(new Event('input')); }", [selector, value])


def test_key_results_have_units_and_errors(fretting, tab):
    tab.goto((fretting / "report.html").as_uri())
    rows = [row.inner_text() for row in tab.query_selector_all("#results tbody tr")]
    assert [row.split("\t")[0] for row in rows] == ["largest contact force", "largest tangential force", "friction in use", "friction work", "stick zone", "largest displacement", "largest pressure"]
    assert "N/mm" in rows[0] and "N/mm" in rows[1] and "64 %" in rows[2] and "mJ/mm" in rows[3] and "\t± 0.0" in rows[4] and "mm" in rows[5] and "MPa" in rows[6]
    assert "%" in rows[6].split("\t")[3]


def test_a_loop_tells_its_energy(fretting, tab):
    """The area of force against displacement is the friction work of the cycle, but for corners cut by the increments."""
    tab.goto((fretting / "report.html").as_uri())
    work = json.loads((fretting / "run.json").read_text())["cycle"]["friction_work"]
    assert tab.input_value("#across") == "support cylinder:top: u_x" and tab.input_value("#up") == "support cylinder:top: f_x"
    for across, up in [(None, None), ("probe top/a: u_x", "contact cylinder:bottom: f_x")]:
        if across:
            tab.select_option("#across", label=across)
            tab.select_option("#up", label=up)
        told = tab.inner_text("#loop")
        assert "t = 2 to 6 s" in told and told.endswith("mJ/mm.")
        assert abs(float(told.split("encloses ")[1].split()[0]) / work - 1) < 0.01
        assert tab.locator("#curve path.arrow").count() == 4
    tab.select_option("#up", label="friction work so far")
    assert "not closed" in tab.inner_text("#loop")
    tab.select_option("#across", label="time")
    assert tab.inner_text("#loop").startswith("A drag zooms")
    assert tab.faults == []


def test_the_cycle_is_that_of_the_report(tmp_path, tab):
    """Two cycles, of which the curve alone would show halves; the other support moves less, and its probe too."""
    moves = ["support[2].history=[[1,0],[2,1],[4,-1],[6,1],[8,-1],[10,1]]", "time.end=10", "time.increments=50", "output.cycle=[6,10]"]
    other = ["support[0].displacement=[-0.001,0]", "support[0].history=[[1,0],[2,1],[4,-1],[6,1],[8,-1],[10,1]]"]
    sets = [*moves, *other, 'output.probe=[{name="side", point=[0, 0]}]']
    stickslip("run", "data/tutorials/fretting.toml", *(word for one in sets for word in ["--set", one]), "--out", tmp_path)
    tab.goto((tmp_path / "report.html").as_uri())
    assert tab.input_value("#across") == "support cylinder:top: u_x"
    for across in ["support cylinder:top: u_x", "probe side: u_x"]:
        tab.select_option("#across", label=across)
        for up in ["support cylinder:top: f_x", "contact cylinder:bottom: sum_p_t", "strain energy"]:
            tab.select_option("#up", label=up)
            told = tab.inner_text("#loop")
            assert "t = 6 to 10 s" in told and "the one before" in told, (across, up, told)
    assert tab.faults == []


def test_names_that_differ_by_a_slash_are_told_apart(fretting, tab):
    tab.goto((fretting / "report.html").as_uri())
    names = tab.locator("#across option").all_inner_texts()
    assert "probe top/a: u_x" in names and "probe top a: u_x" in names


def test_the_body_moves_with_its_slider(page, fretting, tab):
    for report in [page, fretting / "report.html"]:
        tab.goto(report.as_uri())
        drawn = set()
        for scale in [0, 1, 5]:
            set_slider(tab, "#scale", scale)
            drawn.add((tab.inner_text("#times"), tab.evaluate("document.querySelector('#canvas').toDataURL()")))
        assert len({when for when, _ in drawn}) == 3 and len({image for _, image in drawn}) >= 2
        assert "Pa" in tab.inner_text(".legend")
        box = tab.locator("#canvas").bounding_box()
        for k in range(40):
            tab.hover("#canvas", position={"x": box["width"] * (0.3 + 0.01 * k), "y": box["height"] / 2})
            if tab.inner_text("#drawn .note").startswith("At ("):
                break
        assert "displacement (" in tab.inner_text("#drawn .note")
        assert tab.faults == []


def test_a_body_in_space_turns_and_shows_four_results(page, tab, tmp_path):
    tab.goto(page.as_uri())
    image = lambda: tab.evaluate("document.querySelector('#canvas').toDataURL()")
    if "space" not in str(page):
        assert not tab.is_visible("#colour")
        return
    legends, images = set(), {image()}
    for name in tab.locator("#colour option").all_inner_texts():
        tab.select_option("#colour", label=name)
        legends.add(tab.inner_text(".legend"))
        images.add(image())
    assert len(legends) == 4 and len(images) == 4
    assert any("µm" in legend or "mm" in legend for legend in legends) and any("MPa" in legend for legend in legends)
    box, before = tab.locator("#canvas").bounding_box(), image()
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    tab.mouse.move(x, y)
    assert "displacement (" in tab.inner_text("#drawn .note")
    tab.mouse.down()
    tab.mouse.move(x + 100, y + 30)
    tab.mouse.up()
    tab.wait_for_timeout(200)
    turned = image()
    assert turned != before
    tab.mouse.dblclick(x, y)
    tab.wait_for_timeout(200)
    assert image() == before
    with tab.expect_download() as download:
        tab.click("#png")
    download.value.save_as(tmp_path / "body.png")
    assert (tmp_path / "body.png").read_bytes().startswith(b"\x89PNG")
    assert tab.faults == []


def test_a_cycle_is_drawn_along_the_surface(fretting, tmp_path, tab):
    tab.goto((fretting / "report.html").as_uri())
    words = tab.inner_text("#per-cycle")
    assert "slip" in words and "From t = 2 to 6 s. Friction work 0.0485" in words
    for column, unit in [("energy_density", "mJ/mm2"), ("slip_range", "mm"), ("sigma_n_mean", "MPa")]:
        tab.select_option("#cycle-up", label=column)
        assert f"{column}, {unit}" in tab.inner_html("#cycle-chart")
    assert tab.locator("#cycle tbody tr").count() == len((fretting / "cycle.csv").read_text().splitlines()) - 1
    tab.screenshot(path=PICTURES / "report_cycle.png", full_page=True)
    # Several boundaries, and cycles before.
    folder = tmp_path / "cycle"
    shutil.copytree(fretting, folder)
    rows = [f"{name},{k / 10},{k},{k * k / 1000}" for name in ("a/b", "a b") for k in range(50)]
    (folder / "cycle.csv").write_text("boundary,x,node,slip_range\n" + "\n".join(rows) + "\n")
    run = json.loads((folder / "run.json").read_text())
    run["cycle"].update(change=-0.05, earlier=[{"start": k, "end": k + 1, "friction_work": 1 / (k + 1)} for k in range(2)])
    (folder / "run.json").write_text(json.dumps(run))
    stickslip("report", folder)
    tab.goto((folder / "report.html").as_uri())
    assert "5 % less than in the cycle before: it still changes" in tab.inner_text("#facts")
    assert tab.locator("#facts .chart > svg").count() == 1
    assert tab.locator("#cycle-boundary option").all_inner_texts() == ["a/b", "a b"]
    first = tab.inner_text("#cycle tbody tr:first-child")
    tab.click("#cycle th:nth-child(3) button")
    assert tab.inner_text("#cycle tbody tr:first-child") != first
    assert tab.faults == []


def test_a_killed_run_has_a_page(fretting, tmp_path, tab):
    folder = tmp_path / "killed"
    shutil.copytree(fretting, folder)
    (folder / "run.json").unlink()
    stickslip("report", folder)
    tab.goto((folder / "report.html").as_uri())
    assert tab.inner_text(".verdict") == "Unfinished, 60 increments converged so far."
    assert "stress, MPa" in tab.inner_html("#stresses")
    assert not tab.is_visible("#results") and tab.is_visible("#canvas")
    assert tab.faults == []


@pytest.mark.parametrize("size", [DESK, PHONE], ids=["desk", "phone"])
def test_the_page_of_a_sweep_fits_the_screen(tmp_path, browser, size):
    """The chart has the width of the screen, the rows of the table are one line high, and a click on a head sorts them."""
    vary = ["--vary", "contact.friction=0.3,0.6", "--vary", "time.increments=2,4"]
    stickslip("sweep", "doc/lap.toml", *vary, "--plot", "largest_force.magnitude", "--out", tmp_path)
    tab = browser.new_page(viewport=size)
    faults = []
    tab.on("pageerror", lambda error: faults.append(str(error)))
    tab.goto((tmp_path / "sweep.html").as_uri())
    assert tab.evaluate("document.documentElement.scrollWidth") <= size["width"]
    box = tab.locator("#chart > svg").bounding_box()
    assert box["x"] >= 0 and box["x"] + box["width"] <= size["width"]
    assert tab.locator("#chart polyline").count() == 2 and tab.locator("#chart .names span").count() == 2
    assert all(row.bounding_box()["height"] < 40 for row in tab.locator("tbody tr").all())
    first = [row.inner_text() for row in tab.locator("tbody tr").all()]
    tab.locator("th button").first.click()
    tab.locator("th button").first.click()
    assert [row.inner_text() for row in tab.locator("tbody tr").all()] != first
    assert faults == []
    tab.screenshot(path=PICTURES / f"sweep_{size['width']}.png", full_page=True)
    tab.close()
