"""Verbs of `ifgen nodl` that need no running node."""

from __future__ import annotations

from pathlib import Path

import click
from ifgen.command_kit.options import (
    EXISTING_FILE,
    OUTPUT_FILE,
    format_option,
    include_option,
    quiet_option,
    strict_option,
)
from ifgen.diagnostics import Diagnostic, InputError, UsageError

from ifgen_tools.nodl.printing import show

# Late imports: each command loads what it needs, so that the others start fast.


@click.command(epilog="Example: ifgen nodl validate nodl/*.nodl.yaml")
@click.argument("files", metavar="FILE...", nargs=-1, required=True, type=EXISTING_FILE)
@click.option("--no-resolve", is_flag=True, help="Look at the documents alone, and not at their includes.")
@include_option
@strict_option
@quiet_option
@format_option
def validate(
    files: tuple[Path, ...],
    no_resolve: bool,
    include: tuple[Path, ...],
    strict: bool | None,
    quiet: bool,
    format_: str,
) -> int:
    """Check documents by the rules of NoDL, as `ros2 nodl validate` does.

    What ifgen needs beyond those rules to generate code, such as interfaces that exist, gives warnings. They
    are errors with --strict, and in `ifgen check`.
    """
    from ifgen.command_kit import terminal
    from ifgen.nodl.verdict import verdict
    from ifgen.reading.search_path import SearchPath

    search = SearchPath((), include)
    found: list[Diagnostic] = []
    valid: list[str] = []
    for file in files:
        judged = verdict(file, search, follow=not no_resolve, strict=bool(strict))
        found += (*judged.errors, *judged.warnings)
        if not judged.errors:
            valid.append(f"{file}: ok")
    if format_ == "text" and not quiet:
        for line in valid:
            click.echo(line)
    return terminal.print_findings(list(dict.fromkeys(found)), format_, "")


@click.command(epilog="Example: ifgen nodl diff nodl/talker.nodl.yaml described.nodl.yaml")
@click.argument("expected", type=EXISTING_FILE)
@click.argument("actual", type=EXISTING_FILE)
@click.option("--node-name", metavar="NODE", default="/node", help="Full name of the node; default: /node.")
@click.option("--compatible", is_flag=True, help="Take QoS that can meet for equal.")
@include_option
@format_option
def diff(
    expected: Path, actual: Path, node_name: str, compatible: bool, include: tuple[Path, ...], format_: str
) -> int:
    """Compare what two documents say, with all that they include.

    The exit code is 0 if they say the same, 1 if not, and 2 if one of them cannot be read.
    """
    from ifgen_tools.nodl import contract
    from ifgen_tools.nodl.conformance import Choices, compare

    try:
        first, second = (contract.read(path, include).side(node_name) for path in (expected, actual))
    except InputError as error:
        raise UsageError(error.diagnostics) from None
    report = compare(first, second, Choices(compatible))
    return show(report, format_, f"{expected} and {actual} say the same")


@click.command(epilog="Example: ifgen nodl rewrite nodl/talker.nodl.yaml --merge")
@click.argument("source", type=EXISTING_FILE)
@click.option(
    "-o", "--output", metavar="FILE", type=OUTPUT_FILE, help="Write into this file, .yaml or .json."
)
@click.option(
    "-r", "--replace", "replaced", metavar="FROM:=TO", multiple=True, help="Replace a reference; repeatable."
)
@click.option("--merge", is_flag=True, help="Put everything that it includes into one document instead.")
@include_option
def rewrite(
    source: Path, output: Path | None, replaced: tuple[str, ...], merge: bool, include: tuple[Path, ...]
) -> int:
    """Write a document with other references, so that it can be installed.

    Comments and the order stay. No `local://` may be left: each FROM is a reference as it is written, or a
    `local://` to the same file. With --merge the result is one document without includes.
    """
    from ifgen_tools.nodl import contract, rewriting

    if merge:
        loaded = contract.read(source, include).loaded
        text = rewriting.merged(loaded, as_json=output is not None and output.suffix == ".json")
    else:
        text = rewriting.rewritten(source, contract.remaps_of(replaced))
    return _write(text, output)


@click.command(epilog="Example: ifgen nodl migrate robot.nodl.xml -o robot/nodl")
@click.argument("source", type=EXISTING_FILE)
@click.option(
    "-o", "--output", metavar="DIR", type=click.Path(path_type=Path), help="Write NODE.nodl.yaml here."
)
@click.option("--force", is_flag=True, help="Replace files that exist.")
def migrate(source: Path, output: Path | None, force: bool) -> int:
    """Write the XML of NoDL 0.3 as documents of NoDL 2, one for each node.

    What the old form leaves open, such as QoS and defaults, gets ROS' own defaults and a comment.
    """
    from ifgen_tools.nodl.migration import migrated

    documents = migrated(source)
    files = {(output or Path()) / f"{name}.nodl.yaml": text for name, text in documents.items()}
    existing = [file for file in files if output is not None and not force and file.exists()]
    if existing:
        message = f"{existing[0]} exists"
        raise UsageError([Diagnostic("existing-file", message, help="replace it with --force")])
    for number, (file, text) in enumerate(files.items()):
        if output is None:
            click.echo(("---\n" if number else "") + text, nl=False)
        else:
            output.mkdir(parents=True, exist_ok=True)
            _write(text, file)
    return 0


def _write(text: str, output: Path | None) -> int:
    if output is None:
        click.echo(text, nl=False)
    else:
        output.write_text(text, encoding="utf-8")
        click.echo(f"{output}: written")
    return 0


@click.command(epilog="Example: ifgen nodl schema > nodl.schema.json")
def schema() -> int:
    """Print the JSON schema of NoDL, for editors.

    With this line in a description, an editor with yaml-language-server completes it and marks mistakes:

    \b
    # yaml-language-server: $schema=nodl.schema.json
    """  # noqa: D301 - the backspace is for click, which keeps the line after it as it is
    import json

    from ifgen.nodl.schema import schema as of_documents

    click.echo(json.dumps(of_documents(), indent=2))
    return 0


VERBS = (validate, diff, rewrite, migrate, schema)
