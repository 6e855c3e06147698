"""The grammar of ROS names: what is valid, and how a short name becomes a full one.

A validation answers None for a valid name, else (reason, index of the first offending character).
Names are ASCII by definition; what the C layer would cut at a NUL is cut here as well.
"""

from __future__ import annotations

import re
from typing import Final

from .handle import RCLError, RMWError

NameFault = tuple[str, int]

_NOTHING_TO_VALIDATE: Final = "failed to validate name: topic_name argument is null"
NODE_NAME_MAX: Final = 255
FULL_TOPIC_NAME_MAX: Final = 247  # what a DDS name of 255 bytes leaves beside ROS's own prefixes
NAMESPACE_MAX: Final = 245  # one separator and one character of a node name follow it

_NOT_IN_A_PATH = re.compile(r"[^A-Za-z0-9_/]")
_NOT_IN_A_TOKEN = re.compile(r"[^A-Za-z0-9_]")
_TOKEN_WITH_NUMBER = re.compile(r"/[0-9]")
_SUBSTITUTION = re.compile(r"\{([^{}]*)\}")


def as_c_string(name: object, missing: str, error: type[Exception] = RCLError) -> str:
    """A name as a C function sees it: bytes work like a str, and a NUL ends it.

    Raises `error` with the text `missing` for None, TypeError for anything else.
    """
    if name is None:
        raise error(missing)
    if isinstance(name, bytes):
        name = name.decode()
    if not isinstance(name, str):
        raise TypeError(f"a name is a str, not {type(name).__name__}")
    return name.partition("\0")[0]


def as_string(name: object) -> str:
    """A name as a C++ function sees it: as in C, but None is a TypeError like any other class."""
    if name is None:
        raise TypeError("a name is a str, not None")
    return as_c_string(name, "")


def _path_error(path: str, what: str, trailing_slash: str) -> NameFault | None:
    """The first fault of an absolute path of tokens; `what` opens each reason."""
    if not path:
        return f"{what} must not be empty", 0
    if path[0] != "/":
        return f"{what} must be absolute, it must lead with a '/'", 0
    if path[-1] == "/" and trailing_slash:
        return f"{what} {trailing_slash}", len(path) - 1
    if bad := _NOT_IN_A_PATH.search(path):
        return f"{what} must not contain characters other than alphanumerics, '_', or '/'", bad.start()
    repeated, number = path.find("//"), _TOKEN_WITH_NUMBER.search(path)
    if repeated >= 0 and (number is None or repeated < number.start()):
        return f"{what} must not contain repeated '/'", repeated + 1
    if number:
        return f"{what} must not have a token that starts with a number", number.start() + 1
    return None


def rclpy_get_validation_error_for_full_topic_name(name: str) -> NameFault | None:
    """The mistake in a fully expanded topic or service name."""
    name = as_c_string(name, _NOTHING_TO_VALIDATE, RMWError)
    if error := _path_error(name, "topic name", "must not end with a '/'"):
        return error
    if len(name) > FULL_TOPIC_NAME_MAX:
        return "topic length should not exceed '255U - 8U'", FULL_TOPIC_NAME_MAX - 1
    return None


def rclpy_get_validation_error_for_namespace(name: str) -> NameFault | None:
    """The mistake in a namespace."""
    name = as_c_string(name, _NOTHING_TO_VALIDATE, RMWError)
    if name == "/":
        return None
    if error := _path_error(name, "namespace", "must not end with a '/', unless only a '/'"):
        return error
    if len(name) > NAMESPACE_MAX:
        return "namespace should not exceed 'RMW_NAMESPACE_MAX_NAME_LENGTH'", NAMESPACE_MAX - 1
    return None


def rclpy_get_validation_error_for_node_name(name: str) -> NameFault | None:
    """The mistake in a node name."""
    name = as_c_string(name, _NOTHING_TO_VALIDATE, RMWError)
    if not name:
        return "node name must not be empty", 0
    if bad := _NOT_IN_A_TOKEN.search(name):
        return "node name must not contain characters other than alphanumerics or '_'", bad.start()
    if name[0].isdigit():
        return "node name must not start with a number", 0
    if len(name) > NODE_NAME_MAX:
        return f"node name length should not exceed '{NODE_NAME_MAX}'", NODE_NAME_MAX - 1
    return None


def rclpy_get_validation_error_for_topic_name(name: str) -> NameFault | None:
    """The mistake in a topic or service name as a user writes it, before expansion."""
    name = as_c_string(name, _NOTHING_TO_VALIDATE)
    if not name:
        return "topic name must not be empty string", 0
    if name[0].isdigit():
        return "topic name token must not start with a number", 0
    if name[-1] == "/":
        return "topic name must not end with a forward slash", len(name) - 1
    return _substitution_error(name) or _token_error(name)


def _substitution_error(name: str) -> NameFault | None:
    """The first character that cannot stand where it stands; knows about `~` and `{...}`."""
    opened: int | None = None
    for index, char in enumerate(name):
        if char == "{" and opened is None:
            opened = index
        elif char == "}":
            if opened is None:
                return "topic name must not have unmatched (unbalanced) curly braces '{}'", index
            opened = None
        elif char == "~" and index:
            return "topic name must not have tilde '~' unless it is the first character", index
        elif opened is not None:
            if _NOT_IN_A_TOKEN.match(char):
                return "substitution name must not contain characters other than alphanumerics or '_'", index
            if char.isdigit() and index == opened + 1:
                return "substitution name must not start with a number", index
        elif char not in "/~" and _NOT_IN_A_TOKEN.match(char):
            allowed = "alphanumerics, '_', '~', '{', or '}'"
            return f"topic name must not contain characters other than {allowed}", index
    if opened is not None:
        return "topic name must not have unmatched (unbalanced) curly braces '{}'", opened
    return None


def _token_error(name: str) -> NameFault | None:
    if len(name) > 2 and name[0] == "~" and name[1] != "/":
        return "topic name must not have a tilde '~' that is not followed by a forward slash '/'", 1
    if number := _TOKEN_WITH_NUMBER.search(name):
        return "topic name token must not start with a number", number.start() + 1
    return None


def expand_name(name: str, node_name: str, namespace: str) -> str:
    """The absolute name that `name` has inside the node `namespace`/`node_name`; no remapping.

    The node's names are taken as valid. Raises ValueError with the bare reason.
    """
    if error := rclpy_get_validation_error_for_topic_name(name):
        raise ValueError(error[0])
    base = "/" if namespace == "/" else f"{namespace}/"
    expanded = f"{base}{node_name}{name[1:]}" if name[0] == "~" else name
    if "{" in expanded:
        values = {"node": node_name, "ns": namespace, "namespace": namespace}
        expanded = _SUBSTITUTION.sub(lambda found: _substitute(found, values), expanded)
    return expanded if expanded.startswith("/") else base + expanded


def _substitute(found: re.Match[str], values: dict[str, str]) -> str:
    if found[1] not in values:
        raise ValueError(f"unknown substitution: {found[0]}")
    return values[found[1]]


def rclpy_expand_topic_name(topic: str, node_name: str, node_namespace: str) -> str:
    """Make a relative or private name absolute. Raises ValueError when one of the three names is invalid."""
    topic, node_name, node_namespace = (
        as_c_string(name, f"failed to do name expansion: {argument} argument is null")
        for name, argument in (
            (topic, "input_topic_name"),
            (node_name, "node_name"),
            (node_namespace, "node_namespace"),
        )
    )
    if error := rclpy_get_validation_error_for_topic_name(topic):
        raise ValueError(f"topic name '{topic}' is invalid: {error[0]}")
    if error := rclpy_get_validation_error_for_node_name(node_name):
        raise ValueError(f"node name '{node_name}' is invalid: {error[0]}")
    if error := rclpy_get_validation_error_for_namespace(node_namespace):
        raise ValueError(f"node namespace '{node_namespace}' is invalid: {error[0]}")
    try:
        return expand_name(topic, node_name, node_namespace)
    except ValueError as error:
        raise ValueError(f"topic name '{topic}' is invalid: {error}") from None
