"""The command `ifgen conformance`."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import click
from ifgen.command_kit.options import EXISTING_FILE, FOLDER, OUTPUT_FILE
from ifgen.command_kit.tool import ToolCommand

if TYPE_CHECKING:
    from ifgen_tools.conformance.testee import Testee

# Late imports: the suite reads definitions.

_MOST = 20  # failures that are printed


@click.command(
    cls=ToolCommand,
    context_settings={"help_option_names": ["-h", "--help"], "ignore_unknown_options": True},
    epilog="Example: ifgen conformance --only 'hash/*' -- python testee.py",
)
@click.argument("testee", metavar="TESTEE...", nargs=-1, type=click.UNPROCESSED, required=True)
@click.option(
    "--only", metavar="PATTERN", multiple=True, help="Only cases with such a name; may be repeated."
)
@click.option(
    "--failures",
    metavar="FILE",
    type=EXISTING_FILE,
    help="Expected failures, in lines `[some] PATTERN REASON`. If one of them passes, that is an error.",
)
@click.option("--cases", "folder", metavar="DIR", type=FOLDER, help="Another folder with cases/.")
@click.option(
    "--timeout",
    metavar="SECONDS",
    type=click.FloatRange(min=0, min_open=True),
    default=10.0,
    show_default=True,
    help="The longest time that a reply may take.",
)
@click.option(
    "--random",
    "count",
    metavar="N",
    type=click.IntRange(min=1),
    help="Instead of the cases, compare N random messages of each type, as random/PKG/msg/NAME.",
)
@click.option("--junit", metavar="FILE", type=OUTPUT_FILE, help="Write the results as JUnit XML.")
@click.option("--json", "json_file", metavar="FILE", type=OUTPUT_FILE, help="Write the results as JSON.")
def conformance(
    testee: tuple[str, ...],
    only: tuple[str, ...],
    failures: Path | None,
    folder: Path | None,
    timeout: float,
    count: int | None,
    junit: Path | None,
    json_file: Path | None,
) -> int:
    """Test a program against the bytes of ROS 2.

    TESTEE is a command that answers requests on its standard input, as docs/conformance.md describes.
    """
    from ifgen.command_kit.tool import ToolError

    from ifgen_tools.conformance.cases import Suite
    from ifgen_tools.conformance.report import Report, read_expectations, run
    from ifgen_tools.conformance.testee import Testee

    program = Testee(testee, timeout)
    if count is not None:
        if failures or junit or json_file:
            raise click.UsageError("--random has no cases for --failures, --junit and --json")
        return _compare_random(program, folder, count, only)
    expectations = read_expectations(failures) if failures else []
    suite = Suite(only=only) if folder is None else Suite(folder, only)
    try:
        report = Report(program.hello(), expectations)
        failed = 0
        for result in run(program, suite, report):
            if result.outcome == "failed":
                failed += 1
                if failed <= _MOST:
                    print(f"{result.case.name}: {result.detail}")
    finally:
        program.close()
    if not report.results:
        raise ToolError(
            f"no case has a name like {' or '.join(map(repr, only))}",
            "a name is as in alignment/Int8/scalar/3/1:dump",
        )
    if failed > _MOST:
        print(f"... and {failed - _MOST} more failures")
    print("\n".join(report.lines()))
    for sentence in report.unexpected_passes:
        print(f"error: {failures}: {sentence}", file=sys.stderr)
    if junit:
        junit.write_text(report.as_junit(), encoding="utf-8")
    if json_file:
        json_file.write_text(json.dumps(report.as_json(), indent=1) + "\n", encoding="utf-8")
    return 0 if report.is_right else 1


def _compare_random(testee: Testee, folder: Path | None, count: int, only: tuple[str, ...]) -> int:
    """Print the differences and their number; the exit code."""
    from ifgen_tools.conformance import cases
    from ifgen_tools.conformance.random_messages import Comparison, compare

    result = Comparison()
    try:
        definitions = cases.definitions(folder or cases.folder())
        for number, sentence in enumerate(compare(testee, definitions, count, only, result)):
            if number < _MOST:
                print(sentence)
    finally:
        testee.close()
    print(result.line)
    return 0 if result.is_right else 1
