"""argparse as we like it: one-line errors that suggest what was meant, and arguments in any order."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Sequence
from difflib import get_close_matches
from pathlib import Path
from typing import Any, NoReturn


class Parser(argparse.ArgumentParser):
    """A command line or one of its commands. Wrong usage is reported in two lines, with exit code 2."""

    def __init__(self, *, prog: str, description: str = "") -> None:
        super().__init__(prog=prog, description=description, allow_abbrev=False)
        self._rest: tuple[str, Callable[[str], object]] | None = None

    def add_rest(self, dest: str, metavar: str, convert: Callable[[str], object], help: str) -> None:
        """Any number of arguments that are no options, before, between and after those."""
        self.add_argument(dest, metavar=metavar, nargs="*", type=convert, help=help)
        self._rest = dest, convert

    def parse_known_args(  # type: ignore[override]  # its overloads are about the type of the namespace only
        self, args: Sequence[str] | None = None, namespace: Any = None
    ) -> tuple[argparse.Namespace, list[str]]:
        """Parse, and take nothing for granted: what is left over is an argument or a mistake."""
        options, left_over = super().parse_known_args(args, namespace)
        for text in left_over:
            if text.startswith("-") or self._rest is None:
                self.error(self._unknown(text))
            dest, convert = self._rest
            try:
                # argparse takes the arguments up to the next option only
                getattr(options, dest).append(convert(text))
            except argparse.ArgumentTypeError as error:
                self.error(str(error))
        return options, []

    def error(self, message: str) -> NoReturn:
        """Say what is wrong and where to read on."""
        print(f"error: {message}\n  = help: see `{self.prog} --help`", file=sys.stderr)
        sys.exit(2)

    def _unknown(self, text: str) -> str:
        known = [option for action in self._actions for option in action.option_strings]
        close = get_close_matches(text.partition("=")[0], known, n=1)
        kind = "option" if text.startswith("-") else "argument"
        return f"there is no {kind} '{text}'" + (f"; did you mean '{close[0]}'?" if close else "")


def existing_path(text: str) -> Path:
    """A file or folder that is there."""
    if not Path(text).exists():
        raise argparse.ArgumentTypeError(f"'{text}' does not exist")
    return Path(text)


def output_folder(text: str) -> Path:
    """A folder that is there or can be made."""
    if Path(text).exists() and not Path(text).is_dir():
        raise argparse.ArgumentTypeError(f"'{text}' is not a folder")
    return Path(text)


def existing_folder(text: str) -> Path:
    """A folder that is there."""
    if not existing_path(text).is_dir():
        raise argparse.ArgumentTypeError(f"'{text}' is not a folder")
    return Path(text)
