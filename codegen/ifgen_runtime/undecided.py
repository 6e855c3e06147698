"""Marks for what an adapter leaves open: errors for type checkers, and at run time if one is reached."""

from __future__ import annotations

from typing import Never


class UndecidedError(NotImplementedError):
    """A message cannot be converted before a person has decided how: the file, the line and the field."""


class Undecided:
    """The type of what is left to decide. No field takes it, so type checkers report each place."""


def undecided(question: str) -> Undecided:
    """Stand for a value that a person has to decide on; the question names the field."""
    raise _left_open(question)


def lost(value: Never, question: str) -> None:
    """Stand for the decision what becomes of a value that the other version has no field for."""
    raise _left_open(question)


def _left_open(question: str) -> UndecidedError:
    import inspect  # takes longer to import than all adapters

    frame = inspect.stack(0)[2]
    return UndecidedError(f"{frame.filename}:{frame.lineno}: {question}")
