"""The commands about generators: `ifgen generators list`, `describe`, `test` and `new`."""

from __future__ import annotations

import json
import re
import shlex
import sys
from pathlib import Path

import click

from ifgen.command_kit import terminal
from ifgen.command_kit.options import OUTPUT_FOLDER
from ifgen.diagnostics import Diagnostic, InputError, UsageError, shown_path
from ifgen.signals import sigterm_raises

# Late imports: each command loads what it needs, so that the others start fast.


@click.group()
def generators() -> None:
    """Look at generators of other languages, and write one.

    A package brings them: docs/generators.md says how. [tool.ifgen.generate] in pyproject.toml uses them.
    """


@generators.command("list", epilog="Example: ifgen generators list")
def print_list() -> int:
    """List the generators that are installed."""
    from ifgen.pipeline.generators.find import installed, named

    code = 0
    for name, entry_point in sorted(installed().items()):
        package = f"{entry_point.dist.name} {entry_point.dist.version}" if entry_point.dist else ""
        try:
            text = named(name).description
        except InputError as error:
            text, code = error.diagnostics[0].message, 1
        print(f"{name:14} {text} ({package})")
    return code


@generators.command(epilog="Example: ifgen generators describe json-schema")
@click.argument("name")
@click.option("--json", "as_json", is_flag=True, help="Print it as JSON.")
def describe(name: str, as_json: bool) -> int:
    """Show a generator: its options, and what it does not support."""
    from ifgen.generators import FEATURES, protocol
    from ifgen.pipeline.generators.find import named

    found = named(name)
    if as_json:
        print(json.dumps(protocol.description(found), indent=2))
        return 0
    print(f"{found.name} {found.version}: {found.description}")
    if found.options:
        print("\noptions:")
    for option in found.options:
        kind = " | ".join(json.dumps(choice) for choice in option.choices) or option.type
        print(f"  {option.name} = {json.dumps(option.default)}  ({kind})")
        if option.help:
            print(f"      {option.help}")
    if found.templates is not None:
        from ifgen.generator_py.templates.catalogue import blocks_of

        print("\ntemplates, which `templates` of a target may replace:")
        for template, blocks in blocks_of(found.templates).items():
            print(f"  {template}" + (f"  (blocks: {', '.join(blocks)})" if blocks else ""))
    supported = FEATURES if found.features is None else found.features
    if missing := [words for feature, words in FEATURES.items() if feature not in supported]:
        print(f"\nnot supported: {', '.join(missing)}")
    return 0


@generators.command(epilog="Example: ifgen generators test markdown")
@click.argument("name", metavar="[NAME]", required=False)
@click.option("--command", metavar="COMMAND", help="A program that is a generator, instead of NAME.")
@click.option("--golden", metavar="DIR", type=OUTPUT_FOLDER, help="Compare with the files in this folder.")
@click.option("--update", is_flag=True, help="Write what it makes into that folder, and accept it.")
@click.option("--options", metavar="JSON", default="{}", help='Its options, such as \'{"title": "Acme"}\'.')
@click.option("--corpus", metavar="DIR", type=OUTPUT_FOLDER, help="Only write the corpus into this folder.")
def test(
    name: str | None,
    command: str | None,
    golden: Path | None,
    update: bool,
    options: str,
    corpus: Path | None,
) -> int:
    """Test a generator on interfaces with every trap.

    Two runs must make the same files, members of the model that it does not know must not matter to a
    program, paths must be inside its folder, and what can be parsed must be right.
    """
    from ifgen.config.customization import Target
    from ifgen.pipeline.generators import kit

    if corpus is not None:
        corpus.mkdir(parents=True, exist_ok=True)
        kit.write_corpus(corpus)
        print(f"{shown_path(corpus)}: {terminal.counted(len(kit.corpus()), 'interface')} written")
        return 0
    context = click.get_current_context()
    if bool(name) == bool(command):
        raise click.UsageError("name either a generator or a --command", context)
    if update and golden is None:
        raise click.UsageError("--update needs --golden", context)
    try:
        values = json.loads(options)
    except ValueError as error:
        raise click.UsageError(f"--options is no JSON: {error}", context) from None
    words = tuple(shlex.split(command)) if command else ()
    target = Target(name or "program", Path(), name, words, options=values, base=Path.cwd())
    report = kit.test(target, golden, update=update)
    terminal.print_diagnostics(report.diagnostics, stderr=True)
    for problem in report.problems:
        print(f"error: {problem}", file=sys.stderr)
    if update:
        print(f"{terminal.counted(report.updated, 'golden file')} changed")
    if not report.problems:
        print(f"{name or command}: {terminal.counted(len(report.files), 'file')}, no mistakes")
    return int(bool(report.problems))


@generators.command(epilog="Example: ifgen generators new acme-docs")
@click.argument("name")
@click.option("--in", "folder", metavar="DIR", type=OUTPUT_FOLDER, help="Make its folder here (default: .).")
@click.option("--from", "original", metavar="NAME", help="Begin with a copy of an installed generator.")
def new(name: str, folder: Path | None, original: str | None) -> int:
    """Start a pip package with a generator, its test and CI."""
    if not re.fullmatch(r"[a-z][a-z0-9]*(-[a-z0-9]+)*", name):
        advice = "write small letters, digits and single hyphens, such as acme-docs"
        raise UsageError([Diagnostic("no-path", f"a generator cannot be called '{name}'", help=advice)])
    root = (folder or Path()) / name
    if root.exists():
        message = f"{shown_path(root)} is there already"
        raise UsageError([Diagnostic("foreign-file", message, help="choose another name, or another --in")])
    from ifgen import resources
    from ifgen.writing import transaction

    module = name.replace("-", "_")
    places = {
        "generator.toml": "pyproject.toml",
        "generator_test.py.txt": "tests/test_golden.py",
        "generator_workflow.yml": ".github/workflows/test.yml",
    }
    if original is None:
        places |= {
            "generator.py.txt": f"{module}/__init__.py",
            "generator_page.md.j2": f"{module}/templates/page.md.j2",
            "generator_filters.py.txt": f"{module}/filters.py",
        }
    texts = {
        root / path: resources.skeleton(file, name=name, module=module).encode()
        for file, path in places.items()
    }
    if original is not None:
        from ifgen.pipeline.generators.kit import copy_of

        texts |= {root / module / path: data for path, data in copy_of(original, name, module).items()}
    root.mkdir(parents=True)
    with sigterm_raises():
        transaction.apply(list(texts.items()), root)
    for path in texts:
        print(f"created {shown_path(path)}")
    print(f"next: `pip install -e {shown_path(root)}`, then `ifgen generators test {name}`")
    return 0
