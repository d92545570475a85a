"""Siconos's own solvers, where it is installed."""

from __future__ import annotations

import pytest

import stickslip as ss
from scenes import block

pytest.importorskip("siconos.numerics")


def test_the_judge_tells_a_right_solver_from_one_that_says_it_is_right() -> None:
    scene = block(n=20, increments=40).to_dict()
    scene["load"][1]["traction"] = [10e6, 0.0]
    table = ss.compare(ss.Model(scene), {"bn": "bn", **{name: ss.siconos.fc2d(name) for name in ("NSGS", "LEMKE")}})
    assert table["bn"].converged and table["NSGS"].converged and not table["LEMKE"].converged
    assert table["NSGS"].p_n[-1].sum() == pytest.approx(table["bn"].p_n[-1].sum(), rel=1e-9)
    assert "WRONG: cone" in str(table) and "#cf222e" in table._repr_html_()
