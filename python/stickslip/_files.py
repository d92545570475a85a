"""Files: texts that are read, and files that are complete or not there."""

from __future__ import annotations

import contextlib
import os
import shutil
import stat
import uuid
from collections.abc import Iterator
from typing import IO

from ._errors import SceneError


def scene_text(name: str, path: str | os.PathLike[str]) -> str:
    """The text of a scene file; `name` is that of the argument."""
    kind = os.stat(path).st_mode
    if not (stat.S_ISREG(kind) or stat.S_ISFIFO(kind) or stat.S_ISDIR(kind)):
        # Devices may have no end. A folder has its own message below.
        raise SceneError(f"{name}: {os.fspath(path)} is neither a file nor a pipe")
    with open(path, encoding="utf-8") as file:
        try:
            return file.read()
        except UnicodeDecodeError as error:
            raise SceneError(f"{name}: {os.fspath(path)} is no text in UTF-8: {error.reason} at byte {error.start}") from None


@contextlib.contextmanager
def replaced(path: str) -> Iterator[IO[bytes]]:
    """A file that takes the place of `path` once it is complete; after an error what was there stays."""
    target = os.path.realpath(path)
    folder, there = os.path.dirname(target), os.path.exists(target)
    if not os.path.basename(path) or there and not (os.path.isfile(target) and all(os.access(place, os.W_OK) for place in (target, folder))):
        # A pipe or a device, or a file in a folder that takes no others; a folder and a protected file have their own messages.
        with open(path, "wb") as file:
            yield file
        return
    beside = os.path.join(folder, f".{uuid.uuid4().hex}.part")
    try:
        file = open(beside, "xb")
    except OSError as error:
        raise OSError(error.errno, error.strerror, path) from None
    try:
        with file:
            yield file
        if there:
            shutil.copymode(target, beside)
        os.replace(beside, target)
    except BaseException:
        with contextlib.suppress(OSError):
            os.remove(beside)
        raise
