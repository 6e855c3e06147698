"""Folders for what the processes of one user share with each other, and with nobody else."""

from __future__ import annotations

import os
import stat
from typing import TYPE_CHECKING

from rmw_local.transports.errors import TransportError

if TYPE_CHECKING:
    from pathlib import Path


def own_name() -> str:
    """The name of the user's folders."""
    return f"ifgen-{os.getuid()}"


def own_folder(base: Path) -> Path:
    """The user's folder in `base`, which nobody else can look into. Raises TransportError."""
    folder = base / own_name()
    try:
        folder.mkdir(mode=0o700, exist_ok=True)
        status = folder.lstat()
    except OSError as error:
        raise TransportError(f"{folder} cannot be used: {error.strerror}") from None
    if not stat.S_ISDIR(status.st_mode) or status.st_uid != os.getuid() or status.st_mode & 0o077:
        raise TransportError(f"{folder} has to be a folder that only its owner, this user, can use")
    return folder
