"""What is published: one version, and the licences of what is linked."""

from __future__ import annotations

import re
import shutil
import subprocess
from pathlib import Path

import pytest

import stickslip

ROOT = Path(__file__).resolve().parents[2]


@pytest.mark.parametrize("file, line", [
    ("Cargo.toml", r'\[workspace\.package\]\nversion = "(.*)"'),
    ("CITATION.cff", r"^version: (.*)"),
    ("python/conda/recipe.yaml", r'^  version: "(.*)"'),
])
def test_there_is_one_version(file: str, line: str) -> None:
    found = re.search(line, (ROOT / file).read_text(encoding="utf-8"), re.MULTILINE)
    assert found and found[1] == stickslip.__version__


@pytest.mark.skipif(not shutil.which("cargo"), reason="no cargo here")
def test_licences_are_of_what_is_linked(tmp_path: Path) -> None:
    subprocess.run([ROOT / "python/licences.sh", "stickslip-python", tmp_path], check=True)
    kept = (ROOT / "python/licenses/THIRD-PARTY").read_text(encoding="utf-8")
    new = (tmp_path / "THIRD-PARTY").read_text(encoding="utf-8")
    assert new == kept, "python/licences.sh writes it anew"
