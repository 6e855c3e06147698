"""The command line: processes that run cases, and what they found."""

from __future__ import annotations

import argparse
import ctypes
import faulthandler
import multiprocessing
import os
import subprocess
import sys
import tempfile
import time
from multiprocessing.sharedctypes import RawArray
from pathlib import Path
from typing import Any

from ifgen.wire import plan as planning
from ifgen_runtime.codec.choice import chosen

from ...native import sanitizers
from ..support import OWN_INTERFACES, ROOT, Classes, generate
from .cases import Cases, Disagreement
from .definitions import write_package

_LOW = 3
"""The largest steps of a message in one function, where also small messages are to be called."""


def fuzzed_classes(folder: Path, seed: int, *, large: bool) -> Classes:
    """Bundled types, those of codec_msgs and drawn ones; with `large`, most of them as if they were large."""
    drawn = write_package(folder / "definitions", seed)
    kept = planning.MOST_STEPS
    planning.MOST_STEPS = _LOW if large else kept
    try:
        return generate(folder / "generated", ROOT / "interfaces", OWN_INTERFACES, drawn)
    finally:
        planning.MOST_STEPS = kept


def _run(job: int, options: argparse.Namespace, counts: Any) -> None:
    faulthandler.enable()
    with tempfile.TemporaryDirectory() as folder:
        cases = Cases(options.seed, fuzzed_classes(Path(folder), options.seed + job, large=job % 2 == 1))
        if options.only is not None:
            cases.run(options.only)
            return
        for number in range(job, options.cases, options.jobs):
            counts[job] = number
            try:
                cases.run(number)
            except Disagreement as difference:
                print(f"job {job}: {difference}", flush=True)
                sys.exit(1)
        counts[job] = options.cases


def _sanitized(arguments: list[str]) -> int:
    """Run the same command with the other extension."""
    if reason := sanitizers.why_not():
        print(f"cannot sanitize: {reason}")
        return 2
    with tempfile.TemporaryDirectory() as folder:
        environment = {**os.environ, **sanitizers.build(Path(folder))}
        arguments = [argument for argument in arguments if argument != "--sanitize"]
        command = [sys.executable, "-m", __package__, *arguments]
        return subprocess.run(command, env=environment, check=False).returncode


def main() -> int:
    """Run the cases, say how many there were, and return what a shell should see."""
    parser = argparse.ArgumentParser(
        prog="python -m tests.codec.fuzzing", formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--cases", type=int, default=100_000)
    parser.add_argument("--jobs", type=int, default=2, help="processes; odd ones split most messages")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", type=int, metavar="NUMBER", help="one case, in the job that it belongs to")
    parser.add_argument("--sanitize", action="store_true", help="with C built with ASan and UBSan")
    options = parser.parse_args()
    if options.sanitize:
        return _sanitized(sys.argv[1:])
    jobs = range(options.jobs) if options.only is None else [options.only % options.jobs]
    counts = RawArray(ctypes.c_int64, options.jobs)
    started = time.monotonic()
    context = multiprocessing.get_context("spawn")
    processes = {job: context.Process(target=_run, args=(job, options, counts)) for job in jobs}
    for process in processes.values():
        process.start()
    failed = False
    for job, process in processes.items():
        process.join()
        if process.exitcode:
            failed = True
            print(f"job {job} ended with {process.exitcode} in case {counts[job]}")
    seconds = time.monotonic() - started
    if not failed and options.only is None:
        who = "C and Python" if chosen().extension else f"without C, since {chosen().reason}"
        print(f"{options.cases:,} cases in {seconds:.0f} s: all codecs agree ({who})")
    return int(failed)
