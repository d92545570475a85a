"""A scene with finer meshes until a quantity is known."""

from __future__ import annotations

import json
import pickle
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import stickslip as ss
from scenes import SCENES, block
from test_program import program

SMALL = {"mesh.elements": [20, 20], "time.increments": 8}


def test_it_is_the_study_of_the_program(tmp_path: Path) -> None:
    scene = tmp_path / "block.toml"
    scene.write_text(ss.Model(ss.Scene.example("block"), SMALL)._core.text)
    study = ss.converge(scene, "friction_work", to=0.05)
    told = json.loads(program("converge", str(scene), "--for", "friction_work", "--to", "0.05", "--json").stdout)
    assert study.known and study.status == told["verdict"] and study.unit == "J/m"
    for key in ("value", "uncertainty", "extrapolated", "order_mesh"):
        assert getattr(study, key) == pytest.approx(told[key], rel=1e-12)
    assert [run["mesh"] for run in study.runs] == [run["mesh"] for run in told["runs"]]
    assert study.svg().startswith("<svg") and "friction work" in study.message
    assert pickle.loads(pickle.dumps(study)).value == study.value


def test_numbers_are_si() -> None:
    scene = SCENES / "seal.toml"
    study = ss.converge(scene, "peak", max_runs=3)
    told = json.loads(program("converge", str(scene), "--for", "peak", "--max-runs", "3", "--json").stdout)
    assert (study.unit, told["unit"]) == ("Pa", "MPa") and "MPa" in study.message
    assert study.value == pytest.approx(1e6 * told["value"], rel=1e-9)
    assert study.position == pytest.approx([1e-3 * x for x in told["position"]], rel=1e-9)


@pytest.mark.parametrize(
    "options, said",
    [
        ({"quantity": "pressure"}, "quantity: `pressure` is none of peak, force"),
        ({"quantity": None}, "quantity: None"),
        ({"to": 2}, "to: 2"), ({"to": "a"}, "to: 'a'"), ({"to": True}, "to: True"), ({"ratio": 1.1}, "ratio: 1.1"),
        ({"max_runs": 2}, "max_runs: 2"), ({"within": 0}, "within: 0"), ({"within": float("nan")}, "within: nan"),
        ({"meshes": [20, 10]}, "is no finer than the one before"), ({"meshes": [0]}, "meshes: 0 found, expected a whole number of elements of 1 or more"),
        ({"meshes": ["fine.msh"]}, r"meshes=\[20, 40\]"),
    ],
)
def test_wrong_options(options: dict[str, Any], said: str) -> None:
    arguments = {"quantity": "force", **options}
    with pytest.raises(ValueError, match=said):
        ss.converge(ss.Scene.example("block"), overrides=SMALL, **arguments)


def test_wrong_scenes() -> None:
    with pytest.raises(ss.SceneError, match="friction") as error:
        ss.converge(ss.Scene.example("block"), "force", overrides={"contact.friction": -1})
    assert error.value.key == "contact[0].friction"
    with pytest.raises(TypeError, match="meshes"):
        ss.converge(ss.Scene.example("block"), "force", meshes="fine.msh")
    with pytest.raises(FileNotFoundError):
        ss.converge("nowhere.toml", "force")
    slides = ss.converge(ss.Scene.example("block"), "force", overrides={**SMALL, "contact.friction": 0.1})
    assert slides.status == "not-converged" and not slides.known and slides.uncertainty is None and "--" not in slides.message


@pytest.mark.parametrize("name, options", [
    ("max_runs", {"max_runs": 10**30}), ("max_runs", {"max_runs": np.inf}), ("max_runs", {"max_runs": np.nan}), ("meshes", {"meshes": 5}),
    ("meshes", {"meshes": [-1, 2, 3]}), ("meshes", {"meshes": [1.5, 2, 3]}), ("meshes", {"meshes": [np.nan]}), ("meshes", {"meshes": [True, 2]}),
    ("meshes", {"meshes": np.array(5)}),
])
def test_numbers_of_a_study_are_named(name: str, options: dict[str, object]) -> None:
    with pytest.raises((TypeError, ValueError), match=f"^{name}: "):
        ss.converge(block(n=4), "peak", **options)  # type: ignore[arg-type]


def test_meshes_may_be_an_array() -> None:
    study = ss.converge(block(n=4, increments=2), "force", meshes=np.array([2, 4, 8]), max_runs=3)
    assert [run["elements"] for run in study.runs][0] == 4


def test_a_mesh_file_takes_no_numbers_of_elements() -> None:
    with pytest.raises(ValueError, match="leave out meshes") as raised:
        ss.converge(ss.Scene.example("gmsh"), "peak", meshes=[10, 20])
    assert "--" not in str(raised.value)
