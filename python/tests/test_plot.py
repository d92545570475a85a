"""Pictures: what is the same looks the same, and lines join neighbours only."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import stickslip as ss
from scenes import SCENES, block, needs


@pytest.fixture(autouse=True)
def figures() -> Any:
    needs("matplotlib").use("Agg")
    from matplotlib import pyplot

    yield
    pyplot.close("all")


def colours(ax: Any) -> dict[str, Any]:
    from matplotlib.colors import to_hex

    return {line.get_label(): to_hex(line.get_markeredgecolor()) for line in ax.lines if line.get_label() in ("open", "stick", "slip")}


def test_a_status_has_one_colour_in_all_pictures() -> None:
    pictures = [
        ss.run(block(friction=0.05, increments=4)).plot(), ss.run(block(friction=5.0, increments=4)).plot(0),
        ss.run(block(increments=4)).plot(2), ss.run(SCENES / "cube.toml", {"mesh.elements": [3, 3, 3]}).plot(),
        ss.ContactProblem(np.eye(4), np.eye(4)[:2], np.eye(4)[2:], 0.3).solve([1.0, -1.0, 0.0, 0.0]).plot(),
    ]
    seen = [colours(ax) for ax in pictures]
    assert {name for each in seen for name in each} == {"open", "stick", "slip"}
    assert len({frozenset(each) for each in seen}) > 1, "all pictures have the same statuses, which shows nothing"
    for name in ("open", "stick", "slip"):
        assert len({each[name] for each in seen if name in each}) == 1


def test_lines_join_neighbours_on_one_boundary() -> None:
    result = ss.run(SCENES / "boxed.toml")
    assert len(result.model.boundaries) == 4
    ax = result.plot()
    lines = [line for line in ax.lines if line.get_linestyle() == "-"]
    assert len(lines) == 8
    for line in lines:
        assert (np.diff(line.get_xdata()) > 0).all() and len(line.get_xdata()) == len(result.model.boundaries["bottom"])
    spans = sorted({(line.get_xdata()[0], line.get_xdata()[-1]) for line in lines})
    assert len(spans) == 4 and all(a[1] < b[0] for a, b in zip(spans, spans[1:]))
    assert [label.get_text() for label in ax.get_xticklabels()] == list(result.model.boundaries)


def test_there_is_no_line_in_space_and_none_between_numbers() -> None:
    for overrides in ({"mesh.elements": [3, 3, 3]},):
        ax = ss.run(SCENES / "cube.toml", overrides).plot()
        assert not any(len(line.get_xdata()) for line in ax.lines) and len(ax.collections[0].get_offsets()) == 12
    ax = ss.ContactProblem(np.eye(4), np.eye(4)[:2], np.eye(4)[2:], 0.3).solve([1.0, -1.0, 0.0, 0.0]).plot()
    assert all(line.get_linestyle() == "None" for line in ax.lines)


@pytest.mark.parametrize("second", [False, True])
def test_a_round_boundary_is_drawn_along_its_length(second: bool) -> None:
    """Half a ring: x goes to and fro."""
    n, inner, outer = 24, 1.0, 1.5
    angle = np.radians(np.linspace(-80, 80, n + 1))
    ring = np.column_stack([np.cos(angle), np.sin(angle)])
    points = np.concatenate([inner * ring, outer * ring])
    k = np.arange(n)
    quads = np.stack([k, n + 1 + k, n + 2 + k, k + 1], axis=1)
    cells: list[tuple[str, Any]] = [("quad", quads)]
    if second:
        corners = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
        edges = np.sort(corners[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
        unique, of = np.unique(edges, axis=0, return_inverse=True)
        middles = points[unique].mean(axis=1)
        cells = [("triangle6", np.column_stack([corners, len(points) + of.reshape(-1, 3)]))]
        points = np.concatenate([points, middles])

    def inside(x: Any) -> Any:
        return np.hypot(x[:, 0], x[:, 1]) < 1.1

    def outside(x: Any) -> Any:
        return np.hypot(x[:, 0], x[:, 1]) > 1.4

    scene = {
        "material": {"young": 210e9, "poisson": 0.3},
        "support": [{"boundary": "inside", "fix": ["x", "y"]}],
        "contact": [{"boundary": "outside", "friction": 0.2, "obstacle": {"kind": "plane", "gap": 5.0}}],
        "load": [{"boundary": "outside", "traction": [0.0, 1e3], "history": [[0, 0], [1, 1]]}],
        "time": {"end": 1.0, "increments": 1},
    }
    given = ss.mesh.from_arrays(points, cells, {"inside": inside, "outside": outside})
    result = ss.run(scene, mesh=given)
    from stickslip._plot import _curves

    ((_, nodes, length),) = _curves(result.model)
    steps = np.diff(length)
    assert len(nodes) == len(set(nodes)) == n * (1 + second) + 1 and steps.max() < 1.1 * steps.min()
    assert "along the boundary" in result.plot().get_xlabel()
