"""Messages that belong to services and actions, such as `pkg/srv/Name_Event`, from the texts that bags have.

Bags have either the text of the whole service, as rosbag2 writes it, or one text for each of its messages.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final, TypeAlias

Source: TypeAlias = tuple[str, str, str]
"""The name of a type, the encoding of its text, and the text."""

_NAME: Final = re.compile(r"(?P<of>\w+/(?P<folder>srv|action)/[A-Za-z0-9]+)_(?P<part>\w+)")
_PARTS: Final = {"srv": ("Request", "Response"), "action": ("Goal", "Result", "Feedback")}
_IN_IMPL: Final = {
    "SendGoal": "SendGoalService",
    "GetResult": "GetResultService",
    "FeedbackMessage": "FeedbackMessage",
}


@dataclass(frozen=True, slots=True)
class Whole:
    """The service or the action that a message belongs to, and what `sources` define it."""

    type_name: str
    part: str
    sources: tuple[Source, ...]

    def part_of(self, cls: Any) -> type[Any]:
        """The class of the message, of the class of the whole. Raises AttributeError if there is none."""
        found = cls
        for word in self.part.split("_"):
            found = getattr(found.Impl, _IN_IMPL[word]) if word in _IN_IMPL else getattr(found, word)
        part: type[Any] = found
        return part


def whole_of(type_name: str, sources: Sequence[Source]) -> Whole | None:
    """The service or action that a message belongs to, None if it belongs to none.

    The parts that no text defines are empty: they do not matter for the message.
    """
    match = _NAME.fullmatch(type_name)
    if match is None:
        return None
    of, texts = match["of"], {name: text for name, _, text in sources}
    own = (of, "", texts[of] if of in texts else _joined(of, _PARTS[match["folder"]], texts))
    others = tuple(each for each in sources if each[0] != of and not each[0].startswith(f"{of}_"))
    return Whole(of, match["part"], (own, *others))


def _joined(of: str, parts: Sequence[str], texts: Mapping[str, str]) -> str:
    return "\n---\n".join(texts.get(f"{of}_{part}", "") for part in parts) + "\n"
