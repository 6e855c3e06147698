"""Helpers of the humanoid's benchmarks: rows with the target and the measured value."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Iterable

Row = tuple[str, str, str]
"""What is measured, the target, the measured value."""


def is_quick(doc: str) -> bool:
    """Whether the command line asks for a quick run."""
    parser = argparse.ArgumentParser(description=doc.partition("\n")[0])
    parser.add_argument("--quick", action="store_true", help="fewer goals, poses and pushes")
    return bool(parser.parse_args().quick)


def show(measures: Iterable[Callable[[bool], list[Row]]], quick: bool) -> None:
    """Measure and print, row by row."""
    print("| what | asked | measured |\n|---|---|---|")
    for measure in measures:
        for what, asked, found in measure(quick):
            print(f"| {what} | {asked} | {found} |", flush=True)
