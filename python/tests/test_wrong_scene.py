"""Wrong input of scenes, meshes, runs and results: one clear exception that names the argument or the key."""

from __future__ import annotations

import contextlib
import os
import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import stickslip as ss
from scenes import block
from stickslip import mesh

POINTS = np.array([[0, 0], [0.5, 0], [1, 0], [0, 1], [0.5, 1], [1, 1]], dtype=float)
QUADS = [("quad", [[0, 1, 4, 3], [1, 2, 5, 4]])]
SIDES: dict[str, Any] = {"left": lambda x: x[:, 0] == 0, "bottom": lambda x: x[:, 1] == 0, "top": lambda x: x[:, 1] == 1}


def changed(change: Callable[[dict[str, Any]], object]) -> Callable[[], object]:
    """Runs the block with a change of its keys."""

    def run() -> object:
        scene = block(n=4, increments=2).to_dict()
        change(scene)
        return ss.run(scene)

    return run


def overridden(key: Any, value: Any) -> Callable[[], object]:
    return lambda: ss.run(block(n=4, increments=2), {key: value})


def ran(**options: Any) -> Callable[[], object]:
    return lambda: ss.run(block(n=4, increments=2), **options)


def swept(vary: Any, **options: Any) -> Callable[[], object]:
    return lambda: ss.sweep(block(n=4, increments=2), vary, **options)


def made(points: Any = POINTS, cells: Any = QUADS, boundaries: Any = SIDES, **options: Any) -> Callable[[], object]:
    return lambda: mesh.from_arrays(points, cells, boundaries, **options)


def given(**scene: Any) -> Callable[[], object]:
    """Runs a scene on a mesh in memory."""

    def run() -> object:
        keys = {key: value for key, value in block(n=4).to_dict().items() if key not in ("mesh", "load")} | scene
        return ss.run(keys, mesh=mesh.from_arrays(POINTS, QUADS, SIDES))

    return run


def looked(look: Callable[[ss.Result], object]) -> Callable[[], object]:
    return lambda: look(ss.run(block(n=4, increments=2)))


#: What the message begins with, or has after the kind of the error, and the call.
WRONG: list[tuple[str, Callable[[], object]]] = [
    # Keys of a dictionary.
    (r"contact\[0\]\.friction: ", changed(lambda s: s["contact"][0].update(friction=-0.1))),
    (r"contact\[0\]\.friction: ", changed(lambda s: s["contact"][0].update(friction={1, 2}))),
    (r"contact\[0\]\.frction: |contact\[0\]: .*frction|.*`frction`", changed(lambda s: s["contact"][0].update(frction=0.1))),
    (r"contact\[0\]\.boundary: ", changed(lambda s: s["contact"][0].update(boundary="floor"))),
    (r"mesh\.size\b", changed(lambda s: s["mesh"].update(size=[1.0, -1.0]))),
    (r"mesh\.elements\b", changed(lambda s: s["mesh"].update(elements=[2.5, 2]))),
    (r"mesh\.elements\b", changed(lambda s: s["mesh"].update(elements=[0, 2]))),
    (r"mesh\.kind: ", changed(lambda s: s["mesh"].update(kind="ball"))),
    (r"material\.poisson\b", changed(lambda s: s["material"].update(poisson=0.7))),
    (r"material\.young\b", changed(lambda s: s["material"].update(young=np.nan))),
    (r"material\.young\b", changed(lambda s: s["material"].update(young=[None]))),
    (r"material\.young\[0\]: ", changed(lambda s: s["material"].update(young=[object()]))),
    (r"time\.increments\b", changed(lambda s: s["time"].update(increments=0))),
    (r"time\.end\b", changed(lambda s: s["time"].update(end=-1.0))),
    (r"load\[1\]\.history", changed(lambda s: s["load"][1].update(history=[[1, 0], [0, 1]]))),
    (r"load\[0\]\.traction", changed(lambda s: s["load"][0].update(traction=[0.0]))),
    (r"support\[0\]\.fix", changed(lambda s: s["support"][0].update(fix=["w"]))),
    (r"solver\.method: ", changed(lambda s: s.update(solver={"method": "newton"}))),
    (r"1: keys are words", changed(lambda s: s.update({1: 2}))),
    (r"contact\[0\]\.1: keys are words", changed(lambda s: s["contact"][0].update({1: 2}))),
    (r"time\.end: ", changed(lambda s: s["time"].pop("end"))),
    (r"time: ", changed(lambda s: s.pop("time"))),
    (r"mesh: ", changed(lambda s: s.pop("mesh"))),
    (r"contact\[0\]\.boundary: ", changed(lambda s: s["contact"][0].pop("boundary"))),
    (r"load\[2\]: ", changed(lambda s: s["load"].append({"boundary": "top"}))),
    # Scenes.
    (r"scene: ", lambda: ss.run(3)),  # type: ignore[arg-type]
    (r"scene: ", lambda: ss.Model(None)),  # type: ignore[arg-type]
    (r"keys: ", lambda: ss.Scene([1])),  # type: ignore[arg-type]
    (r"name: ", lambda: ss.Scene.example("ball")),  # type: ignore[arg-type]
    (r"name: ", lambda: ss.Scene.example(3)),  # type: ignore[arg-type]
    (r"text: ", lambda: ss.Scene.from_toml("title = ")),
    (r"text: ", lambda: ss.Scene.from_toml(3)),  # type: ignore[arg-type]
    # Overrides.
    (r"overrides: ", lambda: ss.run(block(), [1])),  # type: ignore[arg-type]
    (r"overrides: ", overridden(3, 0.3)),
    (r"contact\.frction: |.*`frction`", overridden("contact.frction", 0.3)),
    (r"contact\[3\]\.friction: ", overridden("contact[3].friction", 0.3)),
    (r"contact\.friction: ", overridden("contact.friction", {1})),
    (r"mesh elements: ", overridden("mesh elements", [1, 1])),
    (r"contact\[0\]\.friction=0\.3: ", overridden("contact[0].friction=0.3", 1)),
    (r"mesh\.elements: the mesh is given", lambda: ss.Model(block(), {"mesh.elements": [2, 2]}, mesh=mesh.from_arrays(POINTS, QUADS, SIDES))),
    # Options of a run.
    (r"keep_u", ran(keep_u="some")),
    (r"keep_u", ran(keep_u=[7])),
    (r"linear is ", ran(linear="magic")),
    (r"callback: ", ran(callback=3)),
    (r"max_iterations: ", ran(max_iterations=0)),
    (r"max_iterations: ", ran(max_iterations=2.5)),
    (r"tolerance: ", ran(tolerance=2.0)),
    (r"time\.increments: ", overridden("time.increments", "some")),
    (r"time\.increments is 0", overridden("time.increments", 0)),
    (r"time\.increments: ", overridden("time.increments", 1.5)),
    (r"time\.increments: ", overridden("time.increments", [5])),
    (r"time\.increments: ", overridden("time.increments", 10**30)),
    (r"time\.increments: ", overridden("time.increments", np.nan)),
    (r"time\.increments is 0", lambda: ss.Model(block(n=4)).with_({"time.increments": 0})),
    (r"overrides: ", lambda: ss.Model(block(n=4)).with_(5)),  # type: ignore[arg-type]
    (r".*unexpected keyword argument 'magic'", ran(magic=1)),
    (r".*unexpected keyword argument 'companion'", ran(companion=True)),
    # Sweeps.
    (r"vary: ", swept([1])),
    (r"vary\['contact.friction'\]: ", swept({"contact.friction": 0.3})),
    (r"vary\['contact.friction'\]: ", swept({"contact.friction": []})),
    (r"vary\[\('time.end', 'time.increments'\)\]: ", swept({("time.end", "time.increments"): [1.0]})),
    (r"vary: 'time.end' is there twice", swept({"time.end": [1.0], ("time.end", "time.increments"): [(1.0, 2)]})),
    (r"vary: ", swept({3: [1.0]})),
    (r"workers is ", swept({"contact.friction": [0.3]}, workers=0)),
    (r"quantities\['a'\]: ", lambda: ss.sweep(block(n=4, increments=2), {"contact.friction": [0.3]}).table({"a": 3})),  # type: ignore[dict-item]
    (r"name: `pressure` is none of peak", lambda: ss.run(block(n=4, increments=2)).quantity("pressure")),
    # Meshes.
    (r"points", made(points=POINTS[:, 0])),
    (r"points: ", made(points="a word")),
    (r"points: ", made(points=np.column_stack([POINTS, [0, 0, 1, 0, 3, 7]]))),
    (r"mesh: ", lambda: ss.Model(block(), mesh=mesh.from_arrays(np.full_like(POINTS, np.nan), QUADS, {}))),
    (r"cells: ", made(cells=[])),
    (r"cells: ", made(cells=[("octagon", [[0, 1, 2, 3]])])),
    (r"cells: ", made(cells=[("quad", [[0, 1, 4, 30]])])),
    (r"cells: ", made(cells=[("quad", [[0, 1, 4]])])),
    (r"cells: ", made(cells=[("quad", "a word")])),
    (r"cells: ", made(cells=3)),
    (r"cells: ", made(cells=[3])),
    (r"scale: ", made(scale=0.0)),
    (r"scale: ", made(scale=np.nan)),
    (r"boundaries\['far'\]", made(boundaries={"far": lambda x: x[:, 0] == 7})),
    (r"boundaries\['far'\]", made(boundaries={"far": lambda x: True})),
    (r"boundaries\['far'\]", made(boundaries={"far": [[0, 77]]})),
    (r"boundaries\['far'\]", made(boundaries={"far": 3})),
    (r"boundaries: ", made(boundaries=[1])),
    (r"groups\['a'\]", made(groups={"a": [[7]]})),
    (r"mesh: ", lambda: ss.Model(block(), mesh=3)),
    (r"mesh: ", lambda: ss.Model(block(), mesh={"points": POINTS})),
    (r"mesh: ", lambda: ss.Model(block(), mesh=mesh.from_arrays(POINTS, [("quad", [[0, 1, 3, 4]])], {}))),
    (r"contact\[0\]\.boundary: ", given(contact=[{"boundary": "roof", "friction": 0.1, "obstacle": {"kind": "plane", "gap": 0.0}}])),
    (r"support\[0\]\.boundary: ", given(support=[{"boundary": "roof", "fix": ["x"]}])),
    # Results.
    (r"k: ", looked(lambda r: r.displacement(7))),
    (r"k: ", looked(lambda r: r.stress(0.5))),  # type: ignore[arg-type]
    (r"k: ", lambda: ss.run(block(n=4, increments=2), keep_u="none").fields()),
    (r"kind: ", looked(lambda r: r.svg("stress"))),  # type: ignore[arg-type]
    (r"magnification: ", looked(lambda r: r.svg("deformed", magnification=-1.0))),
    (r"magnification: ", looked(lambda r: r.svg(magnification=1.0))),
    (r"boundary: ", looked(lambda r: r.svg(boundary="roof"))),
    (r"form: ", looked(lambda r: r.write_fclib("x", form="dense"))),  # type: ignore[arg-type]
    (r"u", looked(lambda r: r.model and r.model.displacement([1.0]))),
    (r"t: ", looked(lambda r: r.model and r.model.stress(r.u[-1], np.nan))),
]


def test_there_are_sixty() -> None:
    assert len(WRONG) >= 60


@pytest.mark.parametrize("number", range(len(WRONG)))
def test_wrong_input_is_one_clear_error(number: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    pattern, call = WRONG[number]
    with pytest.raises((ValueError, TypeError, IndexError), match=rf"^({pattern})") as caught:
        call()
    words = str(caught.value)
    assert "stickslip " not in words and "--" not in words and "[[" not in words, words
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("call", [ss.run, ss.Model, ss.Scene.from_file, ss.load])
def test_a_file_that_is_not_there(call: Callable[..., object]) -> None:
    with pytest.raises(FileNotFoundError, match="nowhere"):
        call("nowhere.toml")


def test_a_file_that_is_no_result(tmp_path: Path) -> None:
    (tmp_path / "a.npz").write_bytes(b"nothing")
    np.savez(tmp_path / "b.npz", a=np.zeros(3))
    np.savez(tmp_path / "c.npz", words=np.array("[]"))
    for name in "abc":
        with pytest.raises(ValueError, match="path: .* was not written by Result.save"):
            ss.load(tmp_path / f"{name}.npz")


@pytest.mark.parametrize("name, options", [
    ("max_iterations", {"max_iterations": 10**30}), ("max_iterations", {"max_iterations": "a"}), ("max_iterations", {"max_iterations": np.nan}),
    ("tolerance", {"tolerance": "a"}),
])
def test_numbers_of_a_run_are_named(name: str, options: dict[str, object]) -> None:
    with pytest.raises(ValueError, match=rf"^{name}: .* found, (expected|but must be below 2\*\*31)"):
        ss.run(block(n=2, increments=1), **options)  # type: ignore[arg-type]


def test_increments_of_a_result_are_whole_numbers(tmp_path: Path) -> None:
    result = ss.run(block(n=2, increments=1))
    for call in (result.displacement, result.stress, result.plot, lambda k: result.write_fclib(tmp_path / "x", k), result.svg):
        for k in (True, slice(0, 2), 0.0):
            with pytest.raises((TypeError, ValueError), match="^k(ind)?: "):
                call(k)
    with pytest.raises(TypeError, match="^result: a Result expected, int found"):
        ss.cite(5)  # type: ignore[arg-type]


def test_a_damaged_result_is_a_value_error(tmp_path: Path) -> None:
    path, random = tmp_path / "result.npz", np.random.default_rng(0)
    ss.run(block(n=2, increments=1)).save(path)
    whole = np.frombuffer(path.read_bytes(), np.uint8)
    for _ in range(300):
        damaged = whole.copy()
        damaged[random.integers(len(whole))] ^= 1 << random.integers(8)
        path.write_bytes(damaged.tobytes())
        with contextlib.suppress(ValueError):
            ss.load(path)
    with pytest.raises(FileNotFoundError):
        ss.load(tmp_path / "none.npz")


@pytest.mark.parametrize("path", ["", ".", "folder/", ".."])
def test_a_result_is_saved_under_a_name(path: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    with pytest.raises(ValueError, match="^path: .* found, expected the name of a file"):
        ss.run(block(n=2, increments=1)).save(path)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("name, read", [("path", ss.Scene.from_file), ("scene", ss.run), ("scene", lambda path: ss.converge(path, "peak"))])
def test_a_scene_is_a_text_in_a_file(name: str, read: Callable[[Path], object], tmp_path: Path) -> None:
    (tmp_path / "binary").write_bytes(b"title = \xff\xfe")
    with pytest.raises(ss.SceneError, match=f"^{name}: .*binary is no text in UTF-8: .* at byte 8"):
        read(tmp_path / "binary")
    with pytest.raises(FileNotFoundError):
        read(tmp_path / "none")
    with pytest.raises(OSError):
        read(tmp_path)


@pytest.mark.skipif(not os.path.exists("/dev/zero"), reason="devices are files of unix")
def test_a_scene_is_read_from_a_pipe_and_no_device(tmp_path: Path) -> None:
    for name, read in (("path", ss.Scene.from_file), ("scene", ss.run)):
        with pytest.raises(ss.SceneError, match=f"^{name}: /dev/zero is neither a file nor a pipe"):
            read("/dev/zero")  # type: ignore[operator]
    os.mkfifo(tmp_path / "pipe")
    writer = threading.Thread(target=(tmp_path / "pipe").write_text, args=('title = "Piped"\n',))
    writer.start()
    assert ss.Scene.from_file(tmp_path / "pipe").to_dict() == {"title": "Piped"}
    writer.join()


def test_a_full_disk_leaves_the_file_that_was_there(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    result, path = ss.run(block(n=2, increments=1)), tmp_path / "file.npz"
    calls = (result.save, result.write_vtu, result.write_fclib, result.svg().save, block().save)
    for call in calls:
        path.write_text("before")
        path.chmod(0o640)
        mode = path.stat().st_mode
        with monkeypatch.context() as patch:
            patch.setattr(os, "replace", lambda *_: (_ for _ in ()).throw(OSError(28, "No space left on device")))
            with pytest.raises(OSError, match="No space left"):
                call(path)
        assert path.read_text() == "before" and list(tmp_path.iterdir()) == [path]
        call(path)
        assert path.read_bytes() != b"before" and path.stat().st_mode == mode
        with pytest.raises(FileNotFoundError, match="file.npz"):
            call(tmp_path / "none" / "file.npz")
        folder = tmp_path / "folder.npz"
        folder.mkdir()
        with pytest.raises(OSError):
            call(folder)
        folder.rmdir()


@pytest.mark.skipif(os.name == "nt", reason="links need rights there")
def test_a_link_is_followed_to_what_is_replaced(tmp_path: Path) -> None:
    (tmp_path / "link").symlink_to(tmp_path / "there")
    ss.Svg("<svg/>").save(tmp_path / "link")
    assert (tmp_path / "link").is_symlink() and (tmp_path / "there").read_text() == "<svg/>"
