"""Bags as commands open them: mistakes and damage are told to the user in a sentence."""

from __future__ import annotations

import warnings
from collections.abc import Generator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ifgen.command_kit.tool import ToolError

from ifgen_tools.bag.saying import warn

if TYPE_CHECKING:
    from ifgen_runtime.bag import Bag


@contextmanager
def reading(path: Path, *, strict: bool = False, unlimited: bool = False) -> Generator[Bag]:
    """An open bag. Raises ToolError for what is wrong with it; damage that it can pass over is a warning."""
    from ifgen_runtime.bag import Bag, BagError, BagWarning  # most verbs of the command line read no bag

    def show(message: Warning | str, category: type[Warning], *_: Any, **__: Any) -> None:
        if issubclass(category, BagWarning):
            warn(str(message))
        else:
            usual(message, category, *_, **__)

    with warnings.catch_warnings():
        warnings.simplefilter("always", BagWarning)
        usual, warnings.showwarning = warnings.showwarning, show
        try:
            with Bag(path, strict=strict, unlimited=unlimited) as bag:
                yield bag
        except BagError as error:
            raise ToolError(str(error), help=_help(path, str(error))) from None


def _help(path: Path, error: str) -> str:
    from ifgen_runtime.bag.errors import UNPACKS  # the same

    if UNPACKS in error:
        return "if you trust it, read all of it with --unlimited"
    if not path.exists():
        return "name a .mcap or .db3 file, or a folder that `bag record` made"
    return ""
