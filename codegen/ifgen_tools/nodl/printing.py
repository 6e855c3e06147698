"""How `ifgen nodl` prints differences."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

if TYPE_CHECKING:
    from ifgen_tools.nodl.conformance import Report

# Late imports: each form loads what it needs.


def show(report: Report, format_: str, if_none: str, *, strict: bool = False) -> int:
    """Print differences as text, JSON or annotations; the exit code is 1 if there are certain ones."""
    import json

    failed = bool(report.differences if strict else report.failures)
    if format_ == "github":
        from ifgen.command_kit.report import as_github_annotations

        from ifgen_tools.nodl.conformance import diagnostics

        click.echo(as_github_annotations(diagnostics(report)))
    elif format_ == "json":
        groups = {"differences": report.differences, "ignored": report.ignored}
        listed = {
            name: [
                {"kind": each.kind, "section": each.section, "name": each.name, "detail": each.detail}
                for each in group
            ]
            for name, group in groups.items()
        }
        click.echo(json.dumps({"conforms": not failed, **listed}, indent=2, ensure_ascii=False))
    else:
        for each in report.differences:
            click.echo(str(each))
        if not failed:
            click.echo(if_none)
        for each in report.ignored:
            click.echo(f"ignored: {each}")
    return 1 if failed else 0
