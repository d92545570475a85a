"""The paper's block, small, and where the scenes are."""

from __future__ import annotations

import importlib
import os
from pathlib import Path
from typing import Any

import pytest

import stickslip as ss
from stickslip.builder import plane

SCENES = Path(os.environ.get("STICKSLIP_SCENES", Path(__file__).parents[2] / "data" / "scenes"))


def needs(package: str) -> Any:
    """A package that a test needs. Without it the test is skipped, but fails where all packages are installed, as by `make python`."""
    if os.environ.get("STICKSLIP_ALL_PACKAGES"):
        return importlib.import_module(package)
    return pytest.importorskip(package)


def block(n: int = 10, increments: int = 10, friction: float = 0.4, **solver: object) -> ss.Scene:
    scene = (
        ss.Scene.block([1.0, 1.0], [n, n], title="Block")
        .material(young=210e9, poisson=0.3, plane="strain")
        .support("left", "x", "y")
        .contact("bottom", plane(gap=1e-5), friction=friction)
        .load("top", traction=[0.0, -10e6], history=[[0, 0], [1, 1]])
        .load("right", traction=[-10e6, 0.0], history=[[0, 0], [1, 1], [2, 0]])
        .time(end=2.0, increments=increments)
    )
    return scene.solver(**solver) if solver else scene  # type: ignore[arg-type]
