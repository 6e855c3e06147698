"""Failures of the operating system in words for users: the file, the reason, and what to do."""

from __future__ import annotations

import errno
import os
from pathlib import Path
from typing import Final

_ADVICE: Final = {
    errno.ENOSPC: "free some space, or choose a folder on another disk",
    errno.EDQUOT: "free some space, or choose a folder on another disk",
    errno.EFBIG: "the limit on the size of files is too low: see `ulimit -f`",
    errno.EMFILE: "the limit on open files is too low: see `ulimit -n`",
    errno.EACCES: "fix its permissions, or choose another folder",
    errno.EPERM: "fix its permissions, or choose another folder",
    errno.EROFS: "choose another folder: this disk is read-only",
    errno.ENOTDIR: "a part of this path is a file: choose another folder",
    errno.ENAMETOOLONG: "choose a shorter path",
}


def explained(error: OSError) -> str:
    """One line with the file and what is wrong with it, and one with advice if there is any."""
    subject, advice = error.filename, _ADVICE.get(error.errno or 0)
    reason = error.strerror or str(error)
    if subject is None and error.errno == errno.ENOENT and not _has_working_directory():
        subject, reason = "the working directory", "it no longer exists"
        advice = "change to an existing folder"
    elif error.errno == errno.EEXIST and subject is not None and os.path.islink(subject):  # noqa: PTH114 - bytes too
        reason = f"this is a link to {os.readlink(subject)}, which does not exist"  # noqa: PTH115
        advice = "make that folder, or delete the link"
    elif error.errno == errno.EEXIST:
        reason, advice = "this is not a folder", "choose another name, or move the existing file away"
    line = f"error: {subject or 'cannot read or write'}: {reason}"
    return f"{line}\n  = help: {advice}" if advice else line


def _has_working_directory() -> bool:
    try:
        Path.cwd()
    except FileNotFoundError:
        return False
    return True
