"""The commands about generators: `ifgen generators list` and `describe`."""

from __future__ import annotations

import json

import click

from ifgen.diagnostics import InputError

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
    supported = FEATURES if found.features is None else found.features
    if missing := [words for feature, words in FEATURES.items() if feature not in supported]:
        print(f"\nnot supported: {', '.join(missing)}")
    return 0
