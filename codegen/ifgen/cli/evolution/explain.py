"""The text of a warning about two nodes whose definitions of a type differ, for the runtime's entry point."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Final

from ifgen.command_kit import report
from ifgen.diagnostics import printable
from ifgen.evolution.explaining.explanation import Explanation, explained, head

_WIDTH: Final = 80
_LONGEST: Final = 2**14
"""Characters of a text: names may be long, and the other node chose them."""


def explain(mismatch: Mapping[str, Any]) -> str:
    """The text about a mismatch, a `Mismatch` of the runtime as a dictionary, without a line end.

    It fits into 80 columns without colours, because it goes through the logger of a node. Whatever goes
    wrong, the first lines say who met whom.
    """
    try:
        text = _text(explained(mismatch))
    except Exception:  # a node must not fail because of a warning
        text = report.wrapped(head(mismatch), _WIDTH)
    return text if len(text) <= _LONGEST else f"{text[:_LONGEST]}..."


def _text(explanation: Explanation) -> str:
    parts = [report.wrapped(explanation.head, _WIDTH)]
    if explanation.changes:
        parts.append("From that definition to this one:")
        parts.append(report.as_plain_text(explanation.changes, _WIDTH).rstrip("\n"))
    if explanation.left_out:
        parts.append(f"... and {explanation.left_out} more")
    parts.append(
        "\n".join((*(report.wrapped(remark, _WIDTH) for remark in explanation.remarks), _help(explanation)))
    )
    return "\n\n".join(parts)


def _help(explanation: Explanation) -> str:
    lead = "help: "
    advice = "use the same definition in both nodes"
    if explanation.command is None:
        return lead + advice
    who, whose = ("an adapter", "") if explanation.converts is None else (explanation.converts, "its ")
    lines = (
        report.wrapped(f"{advice}. Until then, {who} can convert:", _WIDTH, len(lead)),
        printable(explanation.command),
        f"and set {whose}on_type_mismatch to adapt",
    )
    return lead + f"\n{' ' * len(lead)}".join(lines)
