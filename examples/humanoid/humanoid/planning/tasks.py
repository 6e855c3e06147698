"""Tasks of the robot in words, as people say or write them.

* `walk X Y YAW [for S]`: walk to a pose [m], [m], [rad] in odom; break it off after S seconds
* `dance NAME [BEATS]`: dance; once through without a number of beats
* `look X Y Z [for S]`: look at a point [m] in odom, for 3 s if nothing else is said
* `point X Y Z [for S]`: point at it with the nearer hand, and look there
* `wait S`: do nothing for S seconds
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

Kind = Literal["walk", "dance", "look", "point", "wait"]

FORMS = "`walk X Y YAW`, `dance NAME`, `look X Y Z`, `point X Y Z` or `wait SECONDS`"
"""The tasks that there are, for messages to people."""

_LOOKING = 3.0  # s
_MOST_BEATS = 1000


@dataclass(frozen=True, slots=True)
class Task:
    """One task.

    `place` is (x, y, yaw) of a walk, or the point (x, y, z) to look or point at; `name` is the dance;
    `seconds` is how long to wait, to look, or to walk before the walk is broken off (0: to its end).
    """

    kind: Kind
    place: tuple[float, float, float] = (0.0, 0.0, 0.0)
    name: str = ""
    beats: int = 0
    seconds: float = 0.0
    tries: int = 2


def task_of(words: str) -> Task:
    """The task that words ask for. Raises ValueError."""
    verb, *rest = words.split() or [""]
    try:
        match verb:
            case "walk" | "look" | "point":
                return _with_place(verb, rest)
            case "dance" if rest:
                return _dance(*rest)
            case "wait" if len(rest) == 1:
                return Task("wait", seconds=_time(rest[0]))
    except (ValueError, TypeError):
        pass
    raise ValueError(f"'{words}' is not a task: say {FORMS}")


def words_of(task: Task) -> str:
    """A task in words."""
    match task.kind:
        case "dance":
            return f"dance {task.name}" + (f" {task.beats}" if task.beats else "")
        case "wait":
            return f"wait {task.seconds:g}"
        case _:
            limit = f" for {task.seconds:g}" if task.seconds else ""
            return f"{task.kind} " + " ".join(f"{part:g}" for part in task.place) + limit


def _with_place(kind: Literal["walk", "look", "point"], words: Sequence[str]) -> Task:
    x, y, last, *limit = words
    seconds = 0.0 if kind == "walk" else _LOOKING
    if limit:
        preposition, time = limit
        if preposition != "for":
            raise ValueError
        seconds = _time(time)
    return Task(kind, place=(_number(x), _number(y), _number(last)), seconds=seconds)


def _dance(name: str, beats: str = "0") -> Task:
    if not 0 <= int(beats) <= _MOST_BEATS:
        raise ValueError
    return Task("dance", name=name, beats=int(beats))


def _number(word: str) -> float:
    number = float(word)
    if not math.isfinite(number):
        raise ValueError
    return number


def _time(word: str) -> float:
    seconds = _number(word)
    if seconds < 0:
        raise ValueError
    return seconds
