"""The commands of CMake that change variables."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Final

from ifgen.reading.cmake import files, lists
from ifgen.reading.cmake.keywords import parsed
from ifgen.reading.cmake.patterns import Unsure
from ifgen.reading.cmake.state import State
from ifgen.reading.cmake.values import EMPTY, Doubt, Value, elements, joined, worse
from ifgen.reading.cmake.words import Word, doubt_of, texts

_VARIABLE: Final = re.compile(r"[A-Za-z_][A-Za-z0-9_.+-]*")

# The words of such commands are names of targets and packages, never of variables to set.
_HARMLESS: Final = (
    *("add_", "ament_", "catkin_", "cmake_minimum_required", "cmake_policy", "configure_file", "enable_"),
    *("export", "generate_messages", "include_directories", "install", "link_", "message", "pluginlib_"),
    *("rclcpp_", "rosidl_", "set_", "source_group", "target_"),
)

# Whatever builds interfaces for ROS 2 has found these, and nothing of ROS 1.
_ALWAYS_FOUND: Final = ("ament_", "builtin_interfaces", "rcl", "ros_environment", "rosidl_", "std_msgs")
_NEVER_FOUND: Final = frozenset({"catkin", "genmsg", "message_generation", "roscpp", "rospy"})


def call(name: str, state: State, words: Sequence[Word]) -> None:
    """Do what a command does to variables; one that is not known may do anything to those that it names."""
    command = _COMMANDS.get(name)
    try:
        if command is not None:
            command(state, words)
        elif not name.startswith(_HARMLESS):
            raise Unsure
    except Unsure:
        suspect(state, words, state.doubt(f"the effect of {name} here is not known", lost=True))


def suspect(state: State, words: Sequence[Word], doubt: Doubt) -> None:
    """Whatever variables the words name are in doubt from now on."""
    for word in words:
        if not word.quoted and _VARIABLE.fullmatch(word.text):
            state.variables.suspect(word.text, doubt)


def _set(state: State, words: Sequence[Word]) -> None:
    if not words:
        return
    name, *rest = words
    if name.text.startswith("ENV{"):
        return
    said = [word.text for word in rest]
    if "CACHE" in said:
        at = said.index("CACHE")
        value = Value(joined(texts(rest[:at])), doubt_of(rest[:at]))
        state.variables.cache(name.text, value, said[-1] == "FORCE" or said[at + 1 : at + 2] == ["INTERNAL"])
        return
    parent = bool(said) and said[-1] == "PARENT_SCOPE"
    rest = rest[:-1] if parent else rest
    value = Value(joined(texts(rest)), worse(name.doubt, doubt_of(rest)))
    state.spend(len(value.text))
    state.variables.set(name.text, value if rest else None, parent)


def _unset(state: State, words: Sequence[Word]) -> None:
    if words and len(words) < 3:
        state.variables.set(words[0].text, None, words[-1].text == "PARENT_SCOPE")


def _option(state: State, words: Sequence[Word]) -> None:
    if words and state.variables.get(words[0].text) is None:
        value = Value(words[2].text, words[2].doubt) if len(words) > 2 else Value("OFF")
        state.variables.set(words[0].text, value)


def _project(state: State, words: Sequence[Word]) -> None:
    if words:
        name, folder = Value(words[0].text, words[0].doubt), Value(state.folder.as_posix())
        for variable in ("PROJECT_NAME", "CMAKE_PROJECT_NAME"):
            state.variables.set(variable, name)
        for variable in ("PROJECT_SOURCE_DIR", f"{name.text}_SOURCE_DIR"):
            state.variables.set(variable, folder)


def _find_package(state: State, words: Sequence[Word]) -> None:
    name, *rest = texts(words) or [""]
    doubt = None
    if name not in _NEVER_FOUND:
        state.variables.packages.add(name)
        if "REQUIRED" not in rest and not name.startswith(_ALWAYS_FOUND):
            doubt = state.doubt(f"it is not known whether package {name} is installed")
    state.variables.set(f"{name}_FOUND", Value("0" if name in _NEVER_FOUND else "1", doubt))


def _find_declared(state: State, words: Sequence[Word]) -> None:
    """Find all that package.xml declares, which is read elsewhere."""
    doubt = state.doubt("it is not known whether it finds a package")
    state.variables.all_are_found = doubt
    for name in _NEVER_FOUND:
        state.variables.set(f"{name}_FOUND", Value("0"))


def _parse_arguments(state: State, words: Sequence[Word]) -> None:
    if len(words) < 4 or words[0].text == "PARSE_ARGV":
        raise Unsure
    prefix, *keywords = words[:4]
    options, single, several = (elements(word.text) for word in keywords)
    found = parsed(texts(words[4:]), options, single, several)
    doubt = doubt_of(words)
    for name in options:
        state.variables.set(f"{prefix.text}_{name}", Value("TRUE" if name in found else "FALSE", doubt))
    for name in (*single, *several):
        value = Value(joined(found[name]), doubt) if name in found else None
        state.variables.set(f"{prefix.text}_{name}", value)
    rest = Value(joined(found[""]), doubt) if found[""] else None
    state.variables.set(f"{prefix.text}_UNPARSED_ARGUMENTS", rest)


def _separate_arguments(state: State, words: Sequence[Word]) -> None:
    match [word.text for word in words]:
        case [name]:
            text, doubt = state.variables.get(name) or EMPTY
        case [name, ("UNIX_COMMAND" | "NATIVE_COMMAND"), text]:
            doubt = doubt_of(words)
        case _:
            raise Unsure
    state.variables.set(name, Value(joined(text.split()), doubt))


Change = tuple[str, str]


def _changing(
    state: State, words: Sequence[Word], changes: Callable[[Sequence[str]], Iterable[Change]]
) -> None:
    """Set what a command changes; a doubt about a word or about a list that is read stays with the result."""
    said = texts(words)
    doubt = doubt_of(words)
    for name, text in changes(said):
        state.spend(len(text))
        state.variables.set(name, Value(text, doubt))


def _list(state: State, words: Sequence[Word]) -> None:
    value = (state.variables.get(words[1].text) if len(words) > 1 else None) or EMPTY
    state.spend(len(value.text))
    read = Word(value.text, True, value.doubt)
    _changing(
        state,
        [*words, Word("", False, read.doubt)],
        lambda said: lists.list_command(said, lambda _: value.text, state.regex),
    )


def _string(state: State, words: Sequence[Word]) -> None:
    doubts: list[Doubt | None] = []
    if len(words) > 1 and words[0].text in {"APPEND", "PREPEND"}:
        doubts.append((state.variables.get(words[1].text) or EMPTY).doubt)
    _changing(
        state,
        [*words, *(Word("", False, doubt) for doubt in doubts)],
        lambda said: lists.string_command(
            said, lambda name: (state.variables.get(name) or EMPTY).text, state.regex
        ),
    )


def _file(state: State, words: Sequence[Word]) -> None:
    _changing(state, words, lambda said: files.file_command(said, state.folder, state.spend))


def _filename_component(state: State, words: Sequence[Word]) -> None:
    _changing(state, words, lambda said: files.filename_component(said, state.folder))


_COMMANDS: Final[Mapping[str, Callable[[State, Sequence[Word]], None]]] = {
    "set": _set,
    "unset": _unset,
    "option": _option,
    "project": _project,
    "find_package": _find_package,
    "ament_auto_find_build_dependencies": _find_declared,
    "cmake_parse_arguments": _parse_arguments,
    "separate_arguments": _separate_arguments,
    "list": _list,
    "string": _string,
    "file": _file,
    "get_filename_component": _filename_component,
}

SETTERS: Final = frozenset(_COMMANDS)
"""The commands that change the variables that they name."""
