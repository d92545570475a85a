"""Exceptions and warnings."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from ._result import Result


class StickslipError(Exception):
    """The base of all of them."""


class SceneError(StickslipError, ValueError):
    """A scene that is not sound.

    Attributes:
        message: what is wrong.
        file, line: where, in the text that was read.
        key: the path of what is wrong, such as ``contact[0].friction``.
        help: what mends it.
    """

    def __init__(
        self, message: str, file: str | None = None, line: int | None = None, key: str | None = None, help: str = ""
    ) -> None:
        place = f"{file}:{line}: " if file is not None else ""
        name = f"{key}: " if key and key not in message else ""
        super().__init__(f"{place}{name}{message}" + (f"\n  help: {help}" if help else ""))
        self.message, self.file, self.line, self.key, self.help = message, file, line, key, help

    def __reduce__(self) -> Any:
        return type(self), (self.message, self.file, self.line, self.key, self.help)


class NotConverged(StickslipError, RuntimeError):
    """Raised by `Result.check`; the incomplete result is `.result`."""

    def __init__(self, message: str, result: Result) -> None:
        super().__init__(message)
        self.result = result

    def __reduce__(self) -> Any:
        return type(self), (self.args[0], self.result)


class NotConvergedWarning(UserWarning):
    """A result that violates a law by more than its tolerance."""
