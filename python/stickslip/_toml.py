"""Dictionaries as the text of a scene, and back."""

from __future__ import annotations

import json
import math
import os
import re
from collections.abc import Mapping
from typing import Any

import numpy as np

from . import _core


def toml_value(value: Any, at: str = "") -> str:
    """A value as TOML, tables inline; `at` is its key, for messages."""
    value = value.tolist() if isinstance(value, (np.ndarray, np.generic)) else value
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, int):
        return str(value)
    if isinstance(value, str):
        return _text(value)
    if isinstance(value, float):
        return repr(value) if math.isfinite(value) else ("nan" if math.isnan(value) else "inf" if value > 0 else "-inf")
    if isinstance(value, os.PathLike):
        return toml_value(os.fspath(value), at)
    if isinstance(value, Mapping):
        return "{ " + ", ".join(f"{_key(k, at)} = {toml_value(v, below(at, k))}" for k, v in value.items() if v is not None) + " }"
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(toml_value(v, f"{at}[{k}]") for k, v in enumerate(value)) + "]"
    raise TypeError(f"{at}: a scene has no values of the type {type(value).__name__}" if at else f"a scene has no values of the type {type(value).__name__}")


def _text(value: str) -> str:
    """In quotes; escapes in pairs, which JSON has for signs such as emoji, are none of TOML."""
    return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")


def below(at: str, name: Any) -> str:
    """The key of `name` in the table `at`."""
    return f"{at}.{name}" if at else str(name)


def _key(name: Any, at: str) -> str:
    if not isinstance(name, str):
        raise TypeError(f"{below(at, name)}: keys are words, {type(name).__name__} found")
    return name if re.fullmatch(r"[A-Za-z0-9_-]+", name) else _text(name)


def to_toml(scene: Mapping[str, Any]) -> str:
    """A dictionary as the text of a scene: tables and lists of tables on lines of their own."""
    plain, tables = [], []
    for name, value in scene.items():
        key = _key(name, "")
        if isinstance(value, Mapping):
            tables += [f"\n[{key}]", *_lines(value, name)]
        elif isinstance(value, (list, tuple)) and value and all(isinstance(item, Mapping) for item in value):
            for k, item in enumerate(value):
                tables += [f"\n[[{key}]]", *_lines(item, f"{name}[{k}]")]
        elif value is not None:
            plain.append(f"{key} = {toml_value(value, name)}")
    return "\n".join([*plain, *tables]) + "\n"


def _lines(table: Mapping[str, Any], at: str) -> list[str]:
    return [f"{_key(name, at)} = {toml_value(value, below(at, name))}" for name, value in table.items() if value is not None]


def from_toml(text: str) -> dict[str, Any]:
    """The keys of a text in TOML; raises `ValueError` with the line where it is none."""
    keys: dict[str, Any] = json.loads(_core.toml_to_json(text))
    return keys
