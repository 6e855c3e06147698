"""The text of a warning: with the toolkit, the fields that differ and their places; without it, one line."""

from __future__ import annotations

from dataclasses import asdict
from importlib.metadata import entry_points
from typing import Final

from ifgen_runtime.mismatch.sides import Mismatch, Side

_GROUP: Final = "ifgen.mismatch"
"""The entry points of what explains a mismatch: `explain(mismatch)`, with a Mismatch as a dictionary."""

_SHOWN: Final = len("RIHS01_") + 16


def explanation(mismatch: Mismatch) -> str:
    """The text of the warning, without a line end: one line, or more if the toolkit is installed.

    It reads files, and takes a part of a second: do not call it in a callback that others wait for. Nothing
    is raised, whatever the definitions are.
    """
    if mismatch.mine.type_hash and mismatch.theirs.type_hash:
        try:
            for found in entry_points(group=_GROUP, name="explain"):
                return str(found.load()(asdict(mismatch)))
        except Exception:  # a broken toolkit must not stop a node
            pass
    return in_one_line(mismatch)


def in_one_line(mismatch: Mismatch) -> str:
    """The same without the toolkit."""
    mine, theirs = mismatch.mine, mismatch.theirs
    if not (mine.type_hash and theirs.type_hash):
        unknown = mine if theirs.type_hash else theirs
        return (
            f"{mismatch.kind} '{mismatch.name}': {unknown.node} ({unknown.role}) does not say which "
            f"definition of {mismatch.type_name} it has, as nodes before ROS 2 Iron. Nobody can tell "
            "whether it is another one"
        )
    return (
        f"{mismatch.kind} '{mismatch.name}': {theirs.node} ({theirs.role}) has another definition of "
        f"{mismatch.type_name} than {mine.node} ({mine.role}): {_hash(theirs)}, not {_hash(mine)}"
    )


def _hash(side: Side) -> str:
    return f"{side.type_hash[:_SHOWN]}..."
