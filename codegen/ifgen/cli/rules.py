"""`ifgen rules`: what each rule is about that a diagnostic may name."""

from __future__ import annotations

import shutil
import textwrap
from collections.abc import Iterable, Iterator

import click

from ifgen.command_kit import completion
from ifgen.config import rulebook
from ifgen.diagnostics import Diagnostic, UsageError


@click.command(epilog="Example: ifgen rules keyword-name")
@click.argument("names", metavar="[RULE]...", nargs=-1, shell_complete=completion.rules)
def rules(names: tuple[str, ...]) -> int:
    """Explain the rules that errors and warnings name.

    Prints a description and an example, as in docs/rules.md. Without RULE, it lists all rules. To silence a
    warning, use `ignore` in [tool.ifgen], or in one place a comment on the line or above it:
    `ifgen: ignore[RULE]`.
    """
    known = rulebook.rules()
    if unknown := [_unknown(name) for name in names if name not in known]:
        raise UsageError(unknown)
    width = max(shutil.get_terminal_size().columns, 60)
    if names:
        print("\n\n".join(_explained(known[name], width) for name in names))
    else:
        print("\n".join(_listed(known.values(), width)))
    return 0


def _explained(rule: rulebook.Rule, width: int) -> str:
    example = textwrap.indent(rule.example, "    ").rstrip()
    return f"{rule.name} ({rule.severity})\n{textwrap.fill(rule.text, width)}\n\n{example}"


def _listed(known: Iterable[rulebook.Rule], width: int) -> Iterator[str]:
    """Each rule with the first sentence about it."""
    kinds = (
        ("warning", False, "Warnings:"),
        ("error", False, "Errors:"),
        ("error", True, "Breaking changes:"),
    )
    for severity, of_changes, title in kinds:
        yield title
        for rule in known:
            if (rule.severity, rule.of_changes) == (severity, of_changes):
                first = f"  {rule.name:24}"
                yield textwrap.fill(
                    rule.summary, width, initial_indent=first, subsequent_indent=" " * len(first)
                )


def _unknown(name: str) -> Diagnostic:
    advice = rulebook.meant(name) or "`ifgen rules` lists them"
    return Diagnostic("unknown-rule", f"there is no rule '{name}'", help=advice)
