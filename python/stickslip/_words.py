"""Numbers in words of messages."""

from __future__ import annotations

from collections.abc import Sequence


def counted(number: int, one: str, several: str = "") -> str:
    """A number with its noun, such as "1 node" and "2 nodes"; `several` where that is not `one` with an s."""
    return f"{number} {one if number == 1 else several or one + 's'}"


def few(words: Sequence[object], most: int = 5, separator: str = ", ") -> str:
    """The first of them, and how many are left out."""
    more = [f"and {len(words) - most} more"] if len(words) > most else []
    return separator.join([*map(str, words[:most]), *more])
