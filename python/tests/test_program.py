"""The program, which the wheel installs as a command."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

import stickslip as ss
from scenes import SCENES

BLOCK = os.fspath(SCENES / "block.toml")
SMALL = ("--set", "mesh.elements=[12,6]", "--set", "time.increments=6")


def program(*arguments: str, **options: object) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "stickslip", *arguments]
    return subprocess.run(command, capture_output=True, text=True, timeout=120, **options)  # type: ignore[call-overload, no-any-return]


def test_it_solves_what_the_module_solves(tmp_path: Path) -> None:
    run = program("run", BLOCK, *SMALL, "--method", "ip", "--solver", "faer", "--json", "--out", os.fspath(tmp_path / "out"))
    assert run.returncode == 0 and not run.stderr
    report = json.loads(run.stdout)
    assert report["status"] == "converged" and (tmp_path / "out" / "report.html").is_file()
    result = ss.run(BLOCK, {"mesh.elements": [12, 6], "time.increments": 6, "solver.method": "ip", "solver.setting": "default"}, linear="faer")
    assert report["forces"][-1]["sum_p_n"] == pytest.approx(result.p_n[-1].sum(), rel=1e-12)


@pytest.mark.parametrize(
    "arguments, status, said",
    [
        (["--version"], 0, ss.__version__),
        (["run", BLOCK, "--set", "solver.max_iterations=1", "--solver", "faer"], 1, "verdict"),
        (["run", "nowhere.toml"], 2, "nowhere.toml"),
        (["run", BLOCK, "--solver", "umfpack"], 2, "umfpack"),
        (["frobnicate"], 2, "frobnicate"),
        ([], 2, "Usage"),
    ],
)
def test_it_ends_with_a_status(arguments: list[str], status: int, said: str, tmp_path: Path) -> None:
    ended = program(*arguments, cwd=tmp_path)
    assert ended.returncode == status and said in ended.stdout + ended.stderr, ended
    assert "Traceback" not in ended.stderr


def test_a_sweep_starts_the_program_again(tmp_path: Path) -> None:
    swept = program("sweep", BLOCK, *SMALL, "--solver", "faer", "--vary", "contact.friction=0.5,0.6", "--out", os.fspath(tmp_path / "out"))
    assert swept.returncode == 0, swept
    assert (tmp_path / "out" / "sweep.html").is_file()


@pytest.mark.skipif(os.name != "posix", reason="signals of Unix")
def test_ctrl_c_ends_it_in_order(tmp_path: Path) -> None:
    out = tmp_path / "out"
    command = [sys.executable, "-m", "stickslip", "run", BLOCK, "--solver", "faer", "--set", "time.increments=4000", "--out", os.fspath(out)]
    # A shell in the background has its children ignore Ctrl-C.
    running = subprocess.Popen(command, stderr=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True, preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler))
    table = out / "increments.csv"
    for _ in range(600):
        if table.is_file() and table.read_text().count("\n") > 2:
            break
        time.sleep(0.1)
    running.send_signal(signal.SIGINT)
    _, said = running.communicate(timeout=60)
    assert running.returncode == 1 and "Traceback" not in said, said
    assert json.loads((out / "run.json").read_text())["status"] == "interrupted"
