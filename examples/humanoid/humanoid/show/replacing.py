"""Somebody's own node in place of one of the robot's: `gait_planner=mine.py`, or `gait_planner=mine.node`."""

from __future__ import annotations

import importlib.util
import sys
import traceback
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import Any

from rclpy.node import Node


class ReplacementError(ValueError):
    """A node cannot be replaced like that; the text says why."""


def split(text: str, known: list[str]) -> tuple[str, str]:
    """The node and its replacement, from `NODE=FILE_OR_MODULE`. Raises ReplacementError."""
    node, equals, place = text.partition("=")
    if not equals or not place:
        raise ReplacementError(f"'{text}': write NODE=FILE_OR_MODULE, such as gait_planner=mine.py")
    return checked(node, known), place


def checked(node: str, known: list[str]) -> str:
    """The name of a node that there is. Raises ReplacementError."""
    if node not in known:
        raise ReplacementError(f"the robot has no node '{node}': it has {', '.join(sorted(known))}")
    return node


def node_class(place: str) -> type[Any]:
    """The node's class in a file or a module; `:NAME` chooses one of several. Raises ReplacementError."""
    where, _, name = place.partition(":")
    module = _loaded(where)
    own = {
        key: value
        for key, value in vars(module).items()
        if isinstance(value, type) and issubclass(value, Node) and value.__module__ == module.__name__
    }
    if name:
        own = {key: value for key, value in own.items() if key == name}
    if len(own) != 1:
        found = f"it has {', '.join(own)}; name one: {where}:{next(iter(own))}" if own else "it has none"
        raise ReplacementError(f"{where}: expected one class that derives from rclpy's Node; {found}")
    (found_class,) = own.values()
    if missing := sorted(getattr(found_class, "__abstractmethods__", ())):
        lacks = f"{where}: {found_class.__name__} lacks {', '.join(missing)}"
        raise ReplacementError(f"{lacks}: define each of them, even if it does nothing")
    return found_class


def _loaded(where: str) -> ModuleType:
    if not where.endswith(".py"):
        try:
            return import_module(where)
        except ImportError as error:
            raise ReplacementError(f"the module {where} cannot be imported: {error}") from None
    path = Path(where).resolve()
    spec = importlib.util.spec_from_file_location(f"replacement_{path.stem}", path)
    if spec is None or spec.loader is None or not path.is_file():
        raise ReplacementError(f"there is no file {where}")
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    sys.path.insert(0, str(path.parent))  # as when Python runs the file
    try:
        spec.loader.exec_module(module)
    except Exception as error:
        lines = [
            frame.lineno for frame in traceback.extract_tb(error.__traceback__) if frame.filename == str(path)
        ]
        line = error.lineno if isinstance(error, SyntaxError) else lines[-1] if lines else None
        place = f"{where}, line {line}" if line else where
        raise ReplacementError(f"{place}: {type(error).__name__}: {error}") from None
    return module
