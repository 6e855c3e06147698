"""Runs an entry point as an installed script would.

`-m ifgen_tools.running.entry_point NAME FOLDER MODULE:FUNCTION ...`; FOLDER is for `sys.path`, and may be
empty. The packages beside it can be imported as well, as in a workspace where all are installed.
"""

from __future__ import annotations

import importlib
import sys
from functools import reduce
from pathlib import Path
from typing import Any


def main() -> int | str | None:
    """Call the function with the arguments that are left, and return its result for `sys.exit`."""
    _, name, folder, target, *arguments = sys.argv
    if folder:
        sys.path.insert(0, folder)
        sys.path += [str(entry.parent) for entry in sorted(Path(folder).parent.glob("*/package.xml"))]
    sys.argv = [name, *arguments]
    module, _, function = target.partition(":")
    found: Any = importlib.import_module(module)
    code: int | str | None = reduce(getattr, function.split("."), found)()
    return code


if __name__ == "__main__":
    sys.exit(main())
