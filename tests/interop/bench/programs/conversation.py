"""How a program is told what to do: a line of JSON for each command on stdin, and each answer on stdout."""

from __future__ import annotations

import base64
import json
import os
import sys
import time
import traceback
from collections.abc import Callable
from importlib import import_module
from importlib.metadata import PackageNotFoundError, version
from typing import Any

Value = dict[str, Any]
"""A message as plain data: a field that is a sequence of bytes is `{"base64": text}`."""


class Cannot(Exception):
    """The implementation does not offer this; the text says what it lacks."""


def converse(make: Callable[[dict[str, Any]], Any], distributions: list[str]) -> None:
    """Do what stdin says until it ends: each command is a method of what `make` returns for the setting.

    The first answer has the versions of the distributions. What has no method is in its `lacks`.
    """
    answers = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(2, 1)  # whatever the implementation prints is no answer

    def answer(**content: Any) -> None:
        answers.write(json.dumps(content) + "\n")
        answers.flush()

    try:
        program = make(json.loads(sys.argv[1]))
        answer(value={name: _version(name) for name in distributions})
    except ModuleNotFoundError as error:
        answer(absent=str(error.name))
        os._exit(0)
    except Exception as error:
        answer(failed=_one_line(error))
        os._exit(0)
    for line in sys.stdin:
        command: dict[str, Any] = json.loads(line)
        try:
            name = command.pop("do")
            if name in program.lacks:
                raise Cannot(program.lacks[name])
            answer(value=getattr(program, name)(**command))
        except Cannot as reason:
            answer(cannot=str(reason))
        except Exception as error:
            traceback.print_exc()
            answer(failed=_one_line(error))
    # Not the usual way out: some implementations crash while Python ends, with threads that still run.
    os._exit(0)


def wait_for(ready: Callable[[], Any], seconds: float) -> bool:
    """Wait until something is true, or as many seconds; returns whether it is."""
    end = time.monotonic() + seconds
    while not ready():
        if time.monotonic() > end:
            return False
        time.sleep(0.01)
    return True


class Receiver:
    """The messages and requests that have come, by the name of their topic or service."""

    def __init__(self) -> None:
        self.came: dict[str, list[Value]] = {}

    def received(self, topic: str, count: int, seconds: float) -> list[Value]:
        """Everything that has come: after as many seconds, or earlier if that is `count` of them."""
        queue = self.came[topic]
        wait_for(lambda: len(queue) >= count, seconds)
        found = queue[:]
        del queue[: len(found)]
        return found


def zenoh_session(setting: dict[str, Any]) -> Any:
    """A bare session of Zenoh, at the router."""
    zenoh: Any = import_module("zenoh")
    configuration = zenoh.Config()
    endpoints = [setting["router"]]
    for path, value in (
        ("mode", "client"),
        ("connect/endpoints", endpoints),
        ("scouting/multicast/enabled", False),
    ):
        configuration.insert_json5(path, json.dumps(value))
    return zenoh.open(configuration)


def packed(data: Any) -> Value:
    """Bytes as plain data."""
    return {"base64": base64.b64encode(bytes(data)).decode()}


def unpacked(value: Value) -> bytes:
    """The opposite of `packed`."""
    return base64.b64decode(value["base64"])


def is_bytes(shape: Any) -> bool:
    """Whether a field of this shape is a sequence of bytes."""
    return isinstance(shape, list) and shape[0] == "uint8"


def plain(message: Any, shape: dict[str, Any]) -> Value:
    """A message as plain data, by its attributes."""
    return {name: _plain(getattr(message, name), inner) for name, inner in shape.items()}


def _plain(value: Any, shape: Any) -> Any:
    if is_bytes(shape):
        return packed(value)
    if isinstance(shape, list):
        return [_plain(each, shape[0]) for each in value]
    if isinstance(shape, dict):
        return plain(value, shape)
    return value.item() if hasattr(value, "item") else value


def _version(distribution: str) -> str:
    try:
        return version(distribution)
    except PackageNotFoundError:
        return ""


def _one_line(error: Exception) -> str:
    lines = str(error).strip().splitlines()
    return f"{type(error).__name__}: {lines[0] if lines else ''}"[:300]
