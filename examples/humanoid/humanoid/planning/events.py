"""What people and the world do while the robot does its tasks, in words: `WHEN: WHAT`.

WHEN is one of
* `12.5`: seconds of simulated time
* `task 2 + 3.5`: seconds after the second task has begun; `+ 0` can be left out
* `after task 2 + 1`: seconds after it has ended

WHAT is one of
* `push MOMENTUM DEGREES`: push the torso [N s] towards a direction, seen from above, in odom
* `press`, `release`: the button of the emergency stop
* `say WORDS`: type words for /speech/typed
* `speak WORDS`: say words that the voice of sensing/voice.py knows, into the microphone
* `joystick FORWARD LEFT TURN for S`: push the sticks, each -1 to 1, with the dead man's button held
* `move NAME X Y`: bring an obstacle to another place [m]
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from typing import Literal

from ..sensing.voice import WORDS

Act = Literal["push", "press", "release", "say", "speak", "joystick", "move"]

_NUMBERS: dict[str, int] = {"push": 2, "press": 0, "release": 0}
_AFTER_TASK = re.compile(r"(after )?task (\d+)(?: *\+ *(\S+))?")
_JOYSTICK = re.compile(r"(\S+) (\S+) (\S+) for (\S+)")
_MOVE = re.compile(r"(\S+) (\S+) (\S+)")
_FORMS = "such as `12.5: push 4 180`, `task 2 + 3: press` or `after task 1: say dance wave`"


@dataclass(frozen=True, slots=True)
class Event:
    """Something that happens once.

    `task` is the number of the task that it waits for (0: none), to end if `after`, else to begin; `delay`
    is the time since then, or since the start [s].
    """

    act: Act
    task: int = 0
    after: bool = False
    delay: float = 0.0
    numbers: tuple[float, ...] = ()
    words: str = ""


def event_of(text: str) -> Event:
    """The event that words describe. Raises ValueError."""
    when, colon, what = (part.strip() for part in text.partition(":"))
    act, _, rest = what.partition(" ")
    try:
        if not colon:
            raise ValueError
        task, after, delay = _when(when)
        words, numbers = _what(act, rest.strip())
    except ValueError:
        raise ValueError(f"'{text}' is not an event: write WHEN: WHAT, {_FORMS}") from None
    return Event(act, task, after, delay, numbers, words)  # type: ignore[arg-type]  # checked by _what


def _when(text: str) -> tuple[int, bool, float]:
    found = _AFTER_TASK.fullmatch(text)
    if found is None:
        return 0, False, _number(text)
    return int(found[2]), bool(found[1]), _number(found[3] or "0")


def _what(act: str, rest: str) -> tuple[str, tuple[float, ...]]:
    match act:
        case "say" if rest:
            return rest, ()
        case "speak" if rest and all(word in WORDS for word in rest.split()):
            return rest, ()
        case "joystick" if found := _JOYSTICK.fullmatch(rest):
            return "", tuple(map(_number, found.groups()))
        case "move" if found := _MOVE.fullmatch(rest):
            name, *place = found.groups()
            return name, tuple(map(_number, place))
    numbers = tuple(map(_number, rest.split()))
    if len(numbers) != _NUMBERS.get(act, -1):
        raise ValueError
    return "", numbers


def _number(text: str) -> float:
    number = float(text)
    if not math.isfinite(number):
        raise ValueError
    return number
