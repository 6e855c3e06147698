"""The remappings that a node takes."""

from collections.abc import Iterable, Sequence
from typing import TypeAlias

from launch.some_substitutions_type import SomeSubstitutionsType
from launch.substitution import Substitution

SomeRemapRule: TypeAlias = tuple[SomeSubstitutionsType, SomeSubstitutionsType]
"""A pair: from, to."""
SomeRemapRules: TypeAlias = Iterable[SomeRemapRule]
RemapRule: TypeAlias = tuple[Sequence[Substitution], Sequence[Substitution]]
"""A pair with its parts as lists."""
RemapRules: TypeAlias = Sequence[RemapRule]
