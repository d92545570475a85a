"""Exceptions and warnings."""

from __future__ import annotations

import re
from typing import Any

#: What the program says, and what this module says in its place.
_WORDS = (
    (r"`stickslip init \w+` shows (the form of every value|a complete scene)", "help(stickslip.builder) shows a complete scene"),
    (r"[;,] `stickslip check` (tells|shows) [^;.]*", ""),
    (r" \(with --set\)", " (with overrides)"),
    (r"\(--for (\w+)\)", r'("\1")'),
    (r"\(--meshes coarse.msh,fine.msh\)", '(meshes=["coarse.msh", "fine.msh"])'),
    (r"\(--meshes 20,40\)", "(meshes=[20, 40])"),
    (r"or remove --meshes", "or leave out meshes"),
    (r"\(--(meshes|within)\)", r"(\1)"),
    (r"\(--max-runs\)", "(max_runs)"),
    (r"; see stickslip run with this mesh", "; run() with this mesh says more"),
)


def in_python(text: str) -> str:
    """Advice of the program in the words of this module.

    Parameters
    ----------
    text : str
        What the library says.

    Returns
    -------
    str
    """
    for said, here in _WORDS:
        text = re.sub(said, here, text)
    return text


class StickslipError(Exception):
    """The base of all of them."""


class SceneError(StickslipError, ValueError):
    """A scene that is not sound.

    Attributes
    ----------
    message : str
        What is wrong.
    file, line : str, int or None
        Where, in the text that was read; None for a dictionary or a `Scene`.
    key : str or None
        The path of what is wrong, such as ``contact[0].friction``.
    help : str
        What mends it.

    Examples
    --------
    >>> import stickslip as ss
    >>> try:
    ...     ss.run(ss.Scene.example("block"), {"contact.friction": -0.3})
    ... except ss.SceneError as error:
    ...     print(error.key)
    contact[0].friction
    """

    def __init__(
        self, message: str, file: str | None = None, line: int | None = None, key: str | None = None, help: str = ""
    ) -> None:
        place = f"{file}:{line}: " if file is not None else ""
        # The key is named once, in front.
        words = re.sub(r", in `[^`]*`$", "", message) if key else message
        name = f"{key}: " if key and not words.startswith(key) else ""
        super().__init__(f"{place}{name}{words}" + (f"\n  help: {help}" if help else ""))
        self.message: str = message
        self.file: str | None = file
        self.line: int | None = line
        self.key: str | None = key
        self.help: str = help

    def __reduce__(self) -> Any:
        return type(self), (self.message, self.file, self.line, self.key, self.help)

    def _in_python(self, has_text: bool) -> SceneError:
        """The error in words of this module; `has_text` if a text was read, which has lines, and no dictionary or `Scene`."""
        file, line = (in_python(self.file) if self.file else None, self.line) if has_text else (None, None)
        message, help = in_python(self.message), in_python(self.help)
        key = self.key
        missing = re.match(r"missing field `(\w+)`", message)
        if missing and not has_text:
            # A table that a scene lacks has no place; what is told is that of the first line.
            of_scene = missing[1] in ("mesh", "material", "time") and not (key or "").startswith("body")
            key, message = (missing[1] if of_scene or not key else f"{key}.{missing[1]}"), "it is missing"
        if not has_text:
            message = re.sub(r"\[\[(\w+)\]\]", r"\1", message)
            help = re.sub(r"write `\[\[\w+\]\]`", "give a list of dictionaries", help)
            help = re.sub(r"write `\[\w+\]`", "give a dictionary", help)
        return SceneError(message, file, line, key, help)


class NotConvergedWarning(UserWarning):
    """A result that violates a law by more than its tolerance."""


class AccuracyWarning(UserWarning):
    """A doubt about the answer of a scene although every law holds; `Result.warnings` has all of them."""
