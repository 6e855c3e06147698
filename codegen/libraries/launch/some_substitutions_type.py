"""Everything that can be written where a text is wanted."""

from collections.abc import Iterable
from pathlib import Path
from typing import TypeAlias

from launch.substitution import Substitution

SomeSubstitutionsType: TypeAlias = str | Path | Substitution | Iterable[str | Path | Substitution]
"""A text, a substitution, or several of these, which are put together."""

SomeSubstitutionsType_types_tuple = (str, Path, Substitution, Iterable)
"""The same for `isinstance`."""
