# Dicts of users are Any.
# pyright: reportUnknownArgumentType=false, reportUnknownLambdaType=false
# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false
"""The places that the lines of a process go to."""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import Any, Final

from launch.launch_context import LaunchContext
from launch.some_substitutions_type import SomeSubstitutionsType
from launch.utilities import performed

_SCREEN: Final = frozenset({"screen"})
_LOG: Final = frozenset({"log"})
_OWN: Final = frozenset({"own_log"})
_MODES: Final = {
    "screen": (_SCREEN, _SCREEN),
    "log": (_LOG, _SCREEN | _LOG),
    "both": (_SCREEN | _LOG, _SCREEN | _LOG),
    "own_log": (_OWN, _OWN),
    "full": (_SCREEN | _LOG | _OWN, _SCREEN | _LOG | _OWN),
}
_FORCED: Final = "OVERRIDE_LAUNCH_PROCESS_OUTPUT"


def places_of(
    context: LaunchContext, output: SomeSubstitutionsType | Mapping[str, Any]
) -> tuple[frozenset[str], frozenset[str]]:
    """Return the places of stdout and of stderr. Raises RuntimeError."""
    output = os.environ.get(_FORCED, output)
    if not isinstance(output, Mapping):
        return _of_mode(performed(context, output))
    streams = {name: _of_stream(value) for name, value in output.items()}
    unknown = streams.keys() - {"stdout", "stderr", "both"}
    if unknown:
        raise RuntimeError(
            f"output has no stream '{min(map(str, unknown))}': there are stdout, stderr and both"
        )
    both = streams.get("both", frozenset())
    return streams.get("stdout", frozenset()) | both, streams.get("stderr", frozenset()) | both


def _of_mode(mode: str) -> tuple[frozenset[str], frozenset[str]]:
    if mode not in _MODES:
        raise RuntimeError(f"output must be one of {', '.join(_MODES)}, got '{mode}'")
    return _MODES[mode]


def _of_stream(value: Any) -> frozenset[str]:
    places: frozenset[str] = frozenset({value} if isinstance(value, str) else value)
    unknown = places - {"screen", "log", "own_log"}
    if unknown:
        raise RuntimeError(f"output has no place '{min(unknown)}': there are screen, log and own_log")
    return places
