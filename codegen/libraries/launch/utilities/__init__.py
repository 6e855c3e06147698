"""Functions about substitutions."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from launch.some_substitutions_type import SomeSubstitutionsType
from launch.substitution import Substitution

if TYPE_CHECKING:
    from launch.launch_context import LaunchContext


def normalize_to_list_of_substitutions(subs: SomeSubstitutionsType) -> list[Substitution]:
    """Return texts and substitutions, however they are written, as a list. Raises TypeError."""
    # It imports this module.
    from launch.substitutions import TextSubstitution

    if isinstance(subs, Substitution):
        return [subs]
    if isinstance(subs, str | Path):
        return [TextSubstitution(text=str(subs))]
    if isinstance(subs, Iterable) and not isinstance(subs, bytes):  # pyright: ignore[reportUnnecessaryIsInstance]  # of users
        return [one for each in subs for one in normalize_to_list_of_substitutions(each)]
    raise TypeError(f"expected a text, a substitution, or a list of these, got {subs!r}")


def perform_substitutions(context: LaunchContext, subs: Iterable[Substitution]) -> str:
    """Return the texts of substitutions, put together."""
    return "".join(each.perform(context) for each in subs)


def performed(context: LaunchContext, subs: SomeSubstitutionsType) -> str:
    """Return the text of what may be written in several ways."""
    return perform_substitutions(context, normalize_to_list_of_substitutions(subs))


def described(subs: Sequence[Substitution]) -> str:
    """Return how substitutions look to people."""
    return " + ".join(each.describe() for each in subs)
