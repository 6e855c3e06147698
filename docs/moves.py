"""Counts what a run of ifgen opens: `python docs/moves.py`, with the ifgen of this environment.

It generates one message and prints how many files and functions of codegen/ run, and how often the run moves
from one file to another. `--files` lists the files, each with the number of moves into it. Imports do not
count, and neither do tables that the first run ever keeps for all later ones.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from types import CodeType, FrameType
from typing import Any, Final

import ifgen

CODEGEN: Final = Path(ifgen.__file__).resolve().parents[1]
_MESSAGE: Final = """\
# A point of a track.
string name
float64 x 1.0   # [m]
int32[] ids
"""


@dataclass
class Moves:
    """The functions that ran, and the number of times that another file had its turn, by file."""

    functions: set[CodeType] = field(default_factory=set[CodeType])
    into: Counter[str] = field(default_factory=Counter[str])
    _last: str = ""

    def note(self, frame: FrameType, event: str, _: Any) -> None:
        """Count a function that starts or goes on, as a profile function."""
        code = frame.f_code
        if event == "call" and code.co_name != "<module>" and code.co_filename.startswith(f"{CODEGEN}/"):
            self.functions.add(code)
            if code.co_filename != self._last:
                self._last = code.co_filename
                self.into[self._last] += 1


def moves_of(run: Callable[[], object]) -> Moves:
    """The moves of a run."""
    moves = Moves()
    sys.setprofile(moves.note)
    try:
        run()
    finally:
        sys.setprofile(None)
    return moves


def main() -> None:
    """Print the figures."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--files", action="store_true", help="list the files, each with the moves into it")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "interfaces/demo_msgs/msg/Track.msg")
        path.parent.mkdir(parents=True)
        path.write_text(_MESSAGE, encoding="utf-8")
        ifgen.generate(path.parents[2], output=Path(folder, "first"))
        moves = moves_of(lambda: ifgen.generate(path.parents[2], output=Path(folder, "generated")))
    if options.files:
        for name, count in sorted(moves.into.items()):
            print(f"{count:5}  {Path(name).relative_to(CODEGEN)}")
    print(f"files run {len(moves.into)}, functions {len(moves.functions)}, moves {moves.into.total()}")


if __name__ == "__main__":
    main()
