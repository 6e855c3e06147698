"""The commands of CMake that change variables."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from pathlib import Path, PurePosixPath
from typing import Final

from ifgen.reading import storage
from ifgen.reading.cmake.state import State
from ifgen.reading.cmake.values import Unsure, Value, by_keyword, elements, glob, texts, worse, worst_in

# The words of such commands are names of targets and packages, never of variables to set.
_HARMLESS: Final = (
    *("add_", "ament_", "catkin_", "cmake_minimum_required", "cmake_policy", "configure_file", "enable_"),
    *("export", "generate_messages", "include_directories", "install", "link_", "message", "pluginlib_"),
    *("rclcpp_", "rosidl_", "set_", "source_group", "target_"),
)

# Whatever builds interfaces for ROS 2 has found these, and nothing of ROS 1.
_ALWAYS_FOUND: Final = ("ament_", "builtin_interfaces", "rcl", "ros_environment", "rosidl_", "std_msgs")
_NEVER_FOUND: Final = frozenset({"catkin", "genmsg", "message_generation", "roscpp", "rospy"})

_MAGIC: Final = frozenset("*?[")
_REFERENCE: Final = re.compile(r"\\(\d)")


def call(name: str, state: State, words: Sequence[Value]) -> None:
    """Do what a command does to variables; one that is not known may do anything to those that it names."""
    try:
        if name in _SETTERS:
            _SETTERS[name](state, words)
        elif name in _COMPUTED:
            doubt = worst_in(words)
            # A doubt about the variable that is changed or read stays with the result, too.
            if name == "list" or (name == "string" and words and words[0].text in {"APPEND", "PREPEND"}):
                doubt = worse(doubt, *(state.variables.value(word.text).doubt for word in words[1:2]))
            for variable, text in _COMPUTED[name](state, texts(words)):
                state.spend(len(text))
                state.variables.set(variable, Value(text, doubt))
        elif not name.startswith(_HARMLESS):
            raise Unsure
    except Unsure:
        state.suspect(words, state.doubt(f"the effect of {name} here is not known", lost=True))


def _set(state: State, words: Sequence[Value]) -> None:
    if not words or words[0].text.startswith("ENV{"):
        return
    name, *rest = words
    said = [word.text for word in rest]
    if "CACHE" in said:
        at = said.index("CACHE")
        forced = said[-1] == "FORCE" or said[at + 1 : at + 2] == ["INTERNAL"]
        if forced or name.text not in state.variables.cached:
            state.variables.cached[name.text] = Value(";".join(texts(rest[:at])), worst_in(rest[:at]))
        return
    parent = said[-1:] == ["PARENT_SCOPE"]
    rest = rest[: len(rest) - parent]
    value = Value(";".join(texts(rest)), worse(name.doubt, worst_in(rest)))
    state.spend(len(value.text))
    state.variables.set(name.text, value if rest else None, parent)


def _unset(state: State, words: Sequence[Value]) -> None:
    if words:
        state.variables.set(words[0].text, None, words[-1].text == "PARENT_SCOPE")


def _option(state: State, words: Sequence[Value]) -> None:
    if words and state.variables.get(words[0].text) is None:
        state.variables.set(words[0].text, words[2] if len(words) > 2 else Value("OFF"))


def _project(state: State, words: Sequence[Value]) -> None:
    for name in words[:1]:
        for variable in ("PROJECT_NAME", "CMAKE_PROJECT_NAME"):
            state.variables.set(variable, name)
        for variable in ("PROJECT_SOURCE_DIR", f"{name.text}_SOURCE_DIR"):
            state.variables.set(variable, Value(state.folder.as_posix()))


def _find_package(state: State, words: Sequence[Value]) -> None:
    name, *rest = texts(words) or [""]
    doubt = None
    if name not in _NEVER_FOUND:
        state.variables.packages.add(name)
        if "REQUIRED" not in rest and not name.startswith(_ALWAYS_FOUND):
            doubt = state.doubt(f"it is not known whether package {name} is installed")
    state.variables.set(f"{name}_FOUND", Value("0" if name in _NEVER_FOUND else "1", doubt))


def _find_declared(state: State, words: Sequence[Value]) -> None:
    """Find all that package.xml declares, which is read elsewhere."""
    state.variables.all_are_found = state.doubt("it is not known whether it finds a package")
    for name in _NEVER_FOUND:
        state.variables.set(f"{name}_FOUND", Value("0"))


def _parse_arguments(state: State, words: Sequence[Value]) -> None:
    if len(words) < 4 or words[0].text == "PARSE_ARGV":
        raise Unsure
    prefix = words[0].text
    options, single, several = (elements(word.text) for word in words[1:4])
    arguments = by_keyword(texts(words[4:]), options, single, several)
    doubt = worst_in(words)
    for name in options:
        state.variables.set(f"{prefix}_{name}", Value("TRUE" if name in arguments else "FALSE", doubt))
    arguments["UNPARSED_ARGUMENTS"] = arguments[""]
    for name in (*single, *several, "UNPARSED_ARGUMENTS"):
        values = arguments.get(name)
        is_set = values is not None and (values or name != "UNPARSED_ARGUMENTS")
        state.variables.set(f"{prefix}_{name}", Value(";".join(values or ()), doubt) if is_set else None)


def _list(state: State, words: Sequence[str]) -> Iterator[tuple[str, str]]:
    action, name, *rest = words if len(words) > 1 else ("", "")
    text = state.variables.value(name).text
    state.spend(len(text))
    items = elements(text, keep_empty=True)
    match action, rest:
        case "APPEND", _:
            yield name, ";".join([*items, *rest])
        case "PREPEND", _:
            yield name, ";".join([*rest, *items])
        case "REMOVE_ITEM", _:
            yield name, ";".join(item for item in items if item not in rest)
        case "REMOVE_DUPLICATES", _:
            yield name, ";".join(dict.fromkeys(items))
        case "SORT", _:  # how does not matter: which interfaces there are is not a question of order
            yield name, ";".join(sorted(items))
        case "FILTER", [("INCLUDE" | "EXCLUDE") as how, "REGEX", pattern]:
            compiled = state.regex(pattern, items)
            yield name, ";".join(item for item in items if bool(compiled.search(item)) == (how == "INCLUDE"))
        case "TRANSFORM", [*change, "OUTPUT_VARIABLE", out]:
            yield out, ";".join(map(_change(state, change, items), items))
        case "TRANSFORM", change:
            yield name, ";".join(map(_change(state, change, items), items))
        case "LENGTH", [out]:
            yield out, str(len(items))
        case "GET", [*at, out]:
            yield out, ";".join(_item(items, one) for one in at)
        case "JOIN", [glue, out]:
            yield out, glue.join(items)
        case _:
            raise Unsure


def _change(state: State, words: Sequence[str], items: Sequence[str]) -> Callable[[str], str]:
    match words:
        case ["APPEND", text]:
            return lambda item: item + text
        case ["PREPEND", text]:
            return lambda item: text + item
        case ["TOLOWER"]:
            return str.lower
        case ["TOUPPER"]:
            return str.upper
        case ["REPLACE", pattern, replacement]:
            compiled = state.regex(pattern, items)
            return lambda item: _replaced(compiled, replacement, item)
        case _:
            raise Unsure


def _string(state: State, words: Sequence[str]) -> Iterator[tuple[str, str]]:
    match list(words):
        case ["REPLACE", old, new, out, *parts]:
            yield out, "".join(parts).replace(old, new) if old else "".join(parts)
        case ["REGEX", "REPLACE", pattern, replacement, out, *parts]:
            text = "".join(parts)
            yield out, _replaced(state.regex(pattern, [text]), replacement, text)
        case ["REGEX", "MATCH", pattern, out, *parts]:
            match = state.regex(pattern, ["".join(parts)]).search("".join(parts))
            yield out, match[0] if match else ""
        case [("APPEND" | "PREPEND") as how, name, *parts]:
            before = state.variables.value(name).text
            yield name, "".join([before, *parts] if how == "APPEND" else [*parts, before])
        case ["CONCAT", out, *parts]:
            yield out, "".join(parts)
        case ["JOIN", glue, out, *parts]:
            yield out, glue.join(parts)
        case ["TOLOWER", text, out]:
            yield out, text.lower()
        case ["TOUPPER", text, out]:
            yield out, text.upper()
        case _:
            raise Unsure


def _file(state: State, words: Sequence[str]) -> Iterator[tuple[str, str]]:
    match list(words):
        case [("GLOB" | "GLOB_RECURSE") as how, out, *rest]:
            yield out, ";".join(_globbed(state, how == "GLOB_RECURSE", rest))
        case ["RELATIVE_PATH", out, start, path]:
            yield out, os.path.relpath(path, start).replace(os.sep, "/")
        case ["TO_CMAKE_PATH" | "TO_NATIVE_PATH", path, out]:
            yield out, path
        case ["MAKE_DIRECTORY" | "COPY" | "WRITE" | "INSTALL" | "REMOVE", *_]:
            return
        case _:
            raise Unsure


def _globbed(state: State, recurse: bool, words: Sequence[str]) -> Iterator[str]:
    """The paths that match, sorted for each pattern."""
    relative: str | None = None
    with_folders = not recurse
    pending = iter(words)
    for word in pending:
        match word:
            case "RELATIVE":
                relative = next(pending, None)
            case "LIST_DIRECTORIES":
                with_folders = next(pending, "").upper() in {"1", "ON", "TRUE", "YES"}
            case "CONFIGURE_DEPENDS" | "FOLLOW_SYMLINKS":
                pass
            case pattern:
                for path in sorted(_matches(state, pattern, recurse, with_folders)):
                    text = path if relative is None else os.path.relpath(path, state.folder / relative)
                    yield text.replace(os.sep, "/")


def _matches(state: State, pattern: str, recurse: bool, with_folders: bool) -> Iterator[str]:
    parts = PurePosixPath(os.path.normpath((state.folder / pattern).as_posix())).parts
    magic = (at for at, part in enumerate(parts) if not _MAGIC.isdisjoint(part))
    fixed = next(magic, len(parts) - 1)
    pending = [(Path(*parts[:fixed]), parts[fixed:])]
    while pending:
        place, (part, *rest) = pending.pop()
        matcher = glob(part)
        for name, is_folder, is_link in _entries(state, place):
            path = place / name
            if matcher.fullmatch(name):
                if rest and is_folder:
                    pending.append((path, tuple(rest)))
                elif not rest and (with_folders or not is_folder):
                    yield path.as_posix()
            if recurse and not rest and is_folder and not is_link:
                pending.append((path, (part,)))


def _entries(state: State, place: Path) -> Iterator[storage.Entry]:
    """The entries of a folder; none if it cannot be read."""
    try:
        for entry in storage.entries(place):
            state.spend(100)
            yield entry
    except (OSError, ValueError):
        return


def _filename_component(state: State, words: Sequence[str]) -> Iterator[tuple[str, str]]:
    match list(words):
        case [out, path, mode] | [out, path, mode, "CACHE"]:
            yield out, _component(path.rstrip("/") or path, mode, state.folder)
        case [out, path, mode, "BASE_DIR", base]:
            yield out, _component(path.rstrip("/") or path, mode, Path(base))
        case _:
            raise Unsure


def _component(path: str, mode: str, base: Path) -> str:
    folder, slash, name = path.rpartition("/")
    stem, dot, extension = name.partition(".")
    last_stem, last_dot, last_extension = name.rpartition(".")
    match mode:
        case "DIRECTORY" | "PATH":
            return folder or (slash if path.startswith("/") else "")
        case "NAME":
            return name
        case "EXT":
            return dot + extension
        case "LAST_EXT":
            return last_dot + last_extension if last_dot else ""
        case "NAME_WE":
            return stem
        case "NAME_WLE":
            return last_stem if last_dot else name
        case "ABSOLUTE" | "REALPATH":
            return Path(os.path.normpath(base / path)).as_posix()
        case _:
            raise Unsure


def _replaced(pattern: re.Pattern[str], replacement: str, text: str) -> str:
    def group(match: re.Match[str], number: int) -> str:
        return (match[number] or "") if number <= pattern.groups else ""

    return pattern.sub(lambda match: _REFERENCE.sub(lambda at: group(match, int(at[1])), replacement), text)


def _item(items: Sequence[str], at: str) -> str:
    if not re.fullmatch(r"-?[0-9]{1,9}", at) or not -len(items) <= int(at) < len(items):
        raise Unsure
    return items[int(at)]


_SETTERS: Final[Mapping[str, Callable[[State, Sequence[Value]], None]]] = {
    "set": _set,
    "unset": _unset,
    "option": _option,
    "project": _project,
    "find_package": _find_package,
    "ament_auto_find_build_dependencies": _find_declared,
    "cmake_parse_arguments": _parse_arguments,
}
_COMPUTED: Final[Mapping[str, Callable[[State, Sequence[str]], Iterable[tuple[str, str]]]]] = {
    "list": _list,
    "string": _string,
    "file": _file,
    "get_filename_component": _filename_component,
}

SETTERS: Final = _SETTERS.keys() | _COMPUTED.keys()
"""The commands that change the variables that they name."""
