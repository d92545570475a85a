"""The factor by which a load may grow until a joint slips."""

from __future__ import annotations

import json
import pickle

import pytest

import stickslip as ss
from scenes import SCENES
from test_program import program


def test_it_is_that_of_the_program() -> None:
    scene = SCENES / "two_blocks.toml"
    found = ss.capacity(scene, 1)
    told = json.loads(program("capacity", str(scene), "--load", "1", "--json").stdout)
    for key in ("load", "safety", "between", "held", "opens", "status", "message", "slip"):
        assert getattr(found, key) == told[key], key
    assert found.holds and found.held in found.message and repr(found) == f"<Capacity {found.message}>"
    assert pickle.loads(pickle.dumps(found)).safety == found.safety


def test_wrong_loads_and_options() -> None:
    scene = SCENES / "two_blocks.toml"
    for load in (7, "nowhere"):
        with pytest.raises(ValueError, match=r"load: there is no load"):
            ss.capacity(scene, load)
    with pytest.raises(ValueError, match="linear: 'lu' found"):
        ss.capacity(scene, linear="lu")  # type: ignore[arg-type]
    with pytest.raises(ss.SceneError, match="friction"):
        ss.capacity(scene, overrides={"contact.friction": -1})
