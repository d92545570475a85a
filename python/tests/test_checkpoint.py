"""A run that is saved as it goes, and goes on from there."""

from __future__ import annotations

import os
import shutil
import signal
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import stickslip as ss

SMALL = {"mesh.elements": [20, 10]}
ARRAYS = ("t", "p_n", "p_t", "contact", "gap", "mu", "w_t_last", "errors", "u", "u_rest", "force")


class PowerCut(Exception):
    pass


def cut_in(increment: int) -> Callable[..., None]:
    def callback(index: int, *_: object) -> None:
        if index == increment:
            raise PowerCut

    return callback


def left(model: ss.Model, file: Path, **options: Any) -> Path:
    with pytest.raises(PowerCut):
        model.run(checkpoint=file, checkpoint_every=0, callback=cut_in(7), **options)
    return file


def without_times(words: Any) -> Any:
    if isinstance(words, dict):
        return {key: without_times(word) for key, word in words.items() if "seconds" not in key and key != "totals"}
    return [without_times(word) for word in words] if isinstance(words, list) else words


@pytest.mark.parametrize("method", ["bn", "ip", "events"])
@pytest.mark.parametrize("options", [{}, {"keep_u": "last"}, {"keep_u": [2, 11]}, {"uniqueness": True}])
def test_a_run_that_goes_on_is_the_whole_run(method: str, options: dict[str, Any], tmp_path: Path) -> None:
    model = ss.Model(ss.Scene.example("block"), {**SMALL, "solver.method": method, "solver.setting": "default"})
    whole = model.run(**options)
    file = left(model, tmp_path / "run.ckpt", **options)
    seen = []
    rest = model.run(checkpoint=file, callback=lambda index, *_: seen.append(index), **options)
    assert seen[0] == 8 and seen[-1] == len(model.t)
    for name in ARRAYS:
        assert np.array_equal(getattr(whole, name), getattr(rest, name)), name
    assert rest.kept == whole.kept and (rest.iterations["increment"] == whole.iterations["increment"]).all()
    assert without_times(rest.report) == without_times(whole.report)
    assert not file.exists()


def test_a_linear_solver_of_ones_own_goes_on(tmp_path: Path) -> None:
    import scipy.sparse as sp
    from scipy.sparse.linalg import splu

    class SuperLU:
        def analyze(self, n: int, indptr: Any, indices: Any) -> None:
            self.pattern = (indices, indptr), (n, n)

        def factorize(self, data: Any) -> None:
            indices, shape = self.pattern
            self.lu = splu(sp.csc_array((data, *indices), shape=shape))

        def solve(self, b: Any) -> Any:
            return self.lu.solve(b)

    model = ss.Model(ss.Scene.example("block"), SMALL)
    file = left(model, tmp_path / "run.ckpt", linear=SuperLU())
    rest = model.run(checkpoint=file, linear=SuperLU())
    assert rest.converged and len(rest.report["increments"]) == len(rest.t)


@pytest.mark.skipif(os.name != "posix", reason="signals of Unix")
def test_ctrl_c_saves_the_increment_in_which_it_came(tmp_path: Path) -> None:
    # A shell in the background has its children ignore Ctrl-C.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    file = tmp_path / "run.ckpt"
    model = ss.Model(ss.Scene.example("block"), SMALL)

    def callback(index: int, *_: object) -> None:
        if index == 7:
            signal.raise_signal(signal.SIGINT)

    with pytest.raises(KeyboardInterrupt) as raised:
        model.run(checkpoint=file, callback=callback)
    if sys.version_info >= (3, 11):
        assert "run.ckpt" in raised.value.__notes__[0]
    seen: list[int] = []
    assert model.run(checkpoint=file, callback=lambda index, *_: seen.append(index)).converged
    assert seen[0] in (8, 9)


def test_an_exception_saves_the_increment_before_it(tmp_path: Path) -> None:
    file = tmp_path / "run.ckpt"
    model = ss.Model(ss.Scene.example("block"), SMALL)
    with pytest.raises(PowerCut):
        model.run(checkpoint=file, callback=cut_in(7))
    seen: list[int] = []
    assert model.run(checkpoint=file, callback=lambda index, *_: seen.append(index)).converged
    assert seen[0] == 8


def test_what_does_not_converge_keeps_its_file(tmp_path: Path) -> None:
    file = tmp_path / "run.ckpt"
    with pytest.warns(ss.NotConvergedWarning):
        slid = ss.run(ss.Scene.example("block"), {**SMALL, "contact.friction": 0.3}, checkpoint=file, checkpoint_every=0)
    assert not slid.converged and file.exists()


def test_a_checkpoint_of_another_run_is_refused(tmp_path: Path) -> None:
    model = ss.Model(ss.Scene.example("block"), SMALL)
    file = left(model, tmp_path / "run.ckpt")
    saved = file.read_bytes()
    with pytest.raises(ValueError, match=r"checkpoint: .*friction = 0.6"):
        ss.run(ss.Scene.example("block"), {**SMALL, "contact.friction": 0.6}, checkpoint=file)
    with pytest.raises(ValueError, match="checkpoint: .*keep_u"):
        model.run(checkpoint=file, keep_u="none")
    with pytest.raises(ValueError, match="checkpoint: .*uniqueness"):
        model.run(checkpoint=file, uniqueness=True)
    assert file.read_bytes() == saved
    for cut in (0, 10, len(saved) // 2, len(saved) - 1):
        file.write_bytes(saved[:cut])
        with pytest.raises(ValueError, match="checkpoint: .*damaged"):
            model.run(checkpoint=file)


def test_a_checkpoint_of_another_mesh_or_tolerance_is_refused(tmp_path: Path) -> None:
    def model(length: float) -> ss.Model:
        x, y = np.meshgrid(np.linspace(0, length, 13), np.linspace(0, 0.1, 13), indexing="ij")
        points = np.column_stack([x.ravel(), y.ravel()])
        corner = np.arange(12)[:, None] * 13 + np.arange(12)
        cells = np.stack([corner, corner + 13, corner + 14, corner + 1], axis=-1).reshape(-1, 4)
        keys = ss.Scene.example("block").to_dict()
        del keys["mesh"]
        sides = {"bottom": lambda x: x[:, 1] == 0, "top": lambda x: x[:, 1] == x[:, 1].max(), "right": lambda x: x[:, 0] == x[:, 0].max()}
        return ss.Model(keys, mesh=ss.mesh.from_arrays(points, [("quad", cells)], sides))

    file = left(model(0.2), tmp_path / "run.ckpt")
    with pytest.raises(ValueError, match="checkpoint: .*the mesh is another"):
        model(0.2001).run(checkpoint=file)
    with pytest.raises(ValueError, match="checkpoint: .*tolerance is another"):
        model(0.2).run(checkpoint=file, tolerance=1e-2)
    assert model(0.2).run(checkpoint=file).converged


def test_two_runs_do_not_share_a_checkpoint(tmp_path: Path) -> None:
    model = ss.Model(ss.Scene.example("block"), SMALL)
    file = tmp_path / "run.ckpt"

    def callback(index: int, *_: object) -> None:
        if index == 3:
            with pytest.raises(ValueError, match="checkpoint: .*in use"):
                model.run(checkpoint=file)

    assert model.run(checkpoint=file, checkpoint_every=0, callback=callback).converged
    assert not list(tmp_path.iterdir())


def test_the_file_stays_where_it_was_when_the_folder_changes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    model = ss.Model(ss.Scene.example("block"), SMALL)
    other = tmp_path / "other"
    other.mkdir()
    (other / "run.ckpt").write_text("precious")
    monkeypatch.chdir(tmp_path)
    assert model.run(checkpoint="run.ckpt", checkpoint_every=0, callback=lambda *_: os.chdir(other)).converged
    assert (other / "run.ckpt").read_text() == "precious" and not (tmp_path / "run.ckpt").exists()


def test_a_run_outlives_its_checkpoint(tmp_path: Path) -> None:
    folder = tmp_path / "gone"
    folder.mkdir()
    model = ss.Model(ss.Scene.example("block"), SMALL)

    def callback(index: int, *_: object) -> None:
        if index == 5:
            shutil.rmtree(folder)

    with pytest.warns(RuntimeWarning, match="checkpoint: .*went on"):
        result = model.run(checkpoint=folder / "run.ckpt", checkpoint_every=0, callback=callback)
    assert result.converged and len(result.t) == 20


@pytest.mark.parametrize(
    "options, error, said",
    [
        ({"checkpoint": 3}, TypeError, "checkpoint: the path"),
        ({"checkpoint": ""}, TypeError, "checkpoint: the path"),
        ({"checkpoint_every": 3.0}, ValueError, "checkpoint_every: .*checkpoint"),
        ({"checkpoint": "run.ckpt", "checkpoint_every": -1.0}, ValueError, "checkpoint_every: -1"),
        ({"checkpoint": "run.ckpt", "checkpoint_every": "often"}, ValueError, "checkpoint_every: 'often'"),
        ({"checkpoint": "nowhere/run.ckpt", "checkpoint_every": 0.0}, FileNotFoundError, "nowhere"),
        ({"checkpoint": "nowhere/run.ckpt"}, FileNotFoundError, "nowhere"),
        ({"checkpoint": "."}, ValueError, "checkpoint: .*regular file"),
        ({"checkpoint": "/dev/full"}, ValueError, "checkpoint: .*regular file"),
        ({"checkpoint": "run.ckpt", "checkpoint_every": 1e300}, ValueError, "checkpoint_every: 1e"),
    ],
)
def test_wrong_checkpoints(
    options: dict[str, Any], error: type[Exception], said: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    with pytest.raises(error, match=said):
        ss.run(ss.Scene.example("block"), SMALL, **options)
