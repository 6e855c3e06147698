"""Messages as JSON in one line, for tools."""

from __future__ import annotations

import json
import math
from typing import Any, Final

from ifgen_tools.texts.yaml_text import Style, plain

_WHOLE: Final = Style()


def as_json(value: Any, info: Any = None) -> str:
    """A message, or the value of a field, as JSON; with its info, as the keys `info` and `message`.

    Floats that JSON cannot hold become "NaN", "Infinity" and "-Infinity", and bytes a text of one character
    each.
    """
    document = plain(value, _WHOLE)
    if info is not None:
        document = {"info": dict(info), "message": document}
    try:
        return json.dumps(document, allow_nan=False, ensure_ascii=False)
    except ValueError:
        return json.dumps(_finite(document), allow_nan=False, ensure_ascii=False)


def _finite(value: Any) -> Any:
    if isinstance(value, dict):
        return {name: _finite(inner) for name, inner in value.items()}
    if isinstance(value, list):
        return [_finite(inner) for inner in value]
    if isinstance(value, float) and not math.isfinite(value):
        return "NaN" if math.isnan(value) else "Infinity" if value > 0 else "-Infinity"
    return value
