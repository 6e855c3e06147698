"""The names that nodes, endpoints and parameters may have: fewer than rclpy and NoDL's schema allow."""

from __future__ import annotations

import keyword
import re
from typing import Final, NamedTuple

_NODE: Final = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")
TYPE: Final = r"([a-zA-Z][a-zA-Z0-9_]*)(?:/(msg|srv|action))?/([A-Z][a-zA-Z0-9_]*)"
_TYPE: Final = re.compile(TYPE)
_IDENTIFIER: Final = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")
ENDPOINT: Final = r"^(~?/[A-Za-z_]|[A-Za-z])[A-Za-z0-9_]*(/[A-Za-z_][A-Za-z0-9_]*)*$"
"""Whole names of topics, services and actions, as `endpoint_name_problem` has them."""

_ENDPOINT_OF_NODL: Final = re.compile(r"[A-Za-z]|[/~A-Za-z][A-Za-z0-9_/]*[A-Za-z0-9_]")

_OF_CLASSES: Final = frozenset(name for name in dir(type) if not name.startswith("__"))
"""Attributes of every class, which a dataclass would take for the default values of its fields."""

PARAMETER: Final = r"^[A-Za-z_][A-Za-z0-9_]*(\.[A-Za-z_][A-Za-z0-9_]*)*$"
"""The characters of a parameter's name. Some such names cannot be attributes all the same."""

MAX_NAME: Final = 255
"""Characters of the name of a node, as rmw has it, and of a parameter."""

MAX_ENDPOINT_NAME: Final = 247
"""Characters of the full name of a topic, as rmw has it."""


class BadName(NamedTuple):
    """The reason why a name is invalid, the characters in question, and what to write instead."""

    message: str
    start: int
    end: int
    advice: str | None = None


def node_name_problem(name: str) -> BadName | None:
    """The reason why a node cannot have this name, which also becomes a Python module."""
    if len(name) > MAX_NAME:
        return BadName(f"has more than {MAX_NAME} characters", 0, len(name))
    advice = "a node's name is that of its file: letters, digits and underscores, no digit first"
    if _NODE.fullmatch(name) is None:
        snake = re.sub(r"[^A-Za-z0-9]+", "_", name).strip("_")
        if _NODE.fullmatch(snake) and not keyword.iskeyword(snake):
            advice = f"did you mean `{snake}`? {advice[:1].upper()}{advice[1:]}"
        return BadName("is not a valid name for a node", 0, len(name), advice)
    if keyword.iskeyword(name):
        return BadName(
            "is a Python keyword, so it cannot be the name of a module", 0, len(name), "rename the file"
        )
    return None


def endpoint_name_problem(name: str) -> BadName | None:
    """The reason why a topic, service or action cannot have this name, as it is written."""
    if not name:
        return BadName("the name is empty", 0, 0)
    if len(name) > MAX_ENDPOINT_NAME:
        return BadName(f"it has more than {MAX_ENDPOINT_NAME} characters", MAX_ENDPOINT_NAME, len(name))
    if name.startswith("~") and not name.startswith("~/"):
        rest = name.lstrip("~/")
        return BadName("`~` stands alone before a `/`", 0, 1, f"did you mean `~/{rest}`?" if rest else None)
    bad = re.search(r"[^A-Za-z0-9_/]", name[1:] if name[0] == "~" else name)
    if bad:
        at = bad.start() + (name[0] == "~")
        return BadName(f"`{name[at]}` cannot be part of a name", at, at + 1, _name_advice(name[at]))
    if "//" in name:
        at = name.index("//")
        return BadName("there are two `/` in a row", at, at + 2, f"did you mean `{re.sub('/+', '/', name)}`?")
    if name.endswith("/"):
        return BadName("a name must not end with `/`", len(name) - 1, len(name))
    digit = re.search(r"(?:^|/)([0-9])", name)
    if digit:
        return BadName("no part of a name may start with a digit", digit.start(1), digit.end(1))
    if name[0] == "_":
        return BadName(
            "a name must not start with `_`", 0, 1, "ROS hides such names; NoDL describes the others"
        )
    return None


def nodl_allows_endpoint(name: str) -> bool:
    """Whether NoDL's schema allows a name that rclpy may still refuse, such as `a//b`."""
    return _ENDPOINT_OF_NODL.fullmatch(name) is not None


def nodl_allows_parameter(name: str) -> bool:
    """Whether NoDL allows a name of a parameter that Python may not: only empty parts are refused."""
    return all(name.split("."))


def _name_advice(character: str) -> str:
    if character in "{}":
        return "NoDL has no substitutions: write the name, or `~/` for the node's own"
    if character == "~":
        return "`~` can only be the first character"
    return "names are letters, digits and underscores, with `/` between the parts"


def expanded(name: str, node: str) -> str:
    """The full name of an endpoint, for a node in the root namespace."""
    if name.startswith("~"):
        return f"/{node}{name[1:]}"
    return name if name.startswith("/") else f"/{name}"


def stem(name: str) -> str:
    """The stem of an endpoint's method names: `joint_states` for `/joint_states`, `a_b` for `~/a/b`."""
    return name.removeprefix("~").lstrip("/").replace("/", "_")


def split_type(text: str) -> tuple[str, str | None, str] | None:
    """Package, folder (None if it is left out) and name of an interface; None if this is no type name."""
    match = _TYPE.fullmatch(text)
    return (match[1], match[2], match[3]) if match else None


def type_advice(text: str, folder: str) -> str:
    """Advice for a text that is not a type name."""
    words = [word for word in re.split(r"[^A-Za-z0-9_]+", text.strip()) if word]
    words = [word for word in words if word not in {"msg", "srv", "action"}]
    if len(words) == 2:
        name = "".join(part[:1].upper() + part[1:] for part in words[1].split("_"))
        candidate = f"{words[0]}/{folder}/{name}"
        if _TYPE.fullmatch(candidate) and candidate != text:
            return f"did you mean `{candidate}`?"
    return f"a type is written `package/{folder}/Name` or `package/Name`"


def parameter_name_problem(name: str) -> BadName | None:
    """The reason why a parameter cannot have this name: each part between dots becomes an attribute."""
    if len(name) > MAX_NAME:
        return BadName(f"it has more than {MAX_NAME} characters", MAX_NAME, len(name))
    start = 0
    for part in name.split("."):
        end = start + len(part)
        if not part:
            what = (
                "the name is empty"
                if not name
                else "there is nothing between two dots, or before or after one"
            )
            return BadName(what, start, end)
        if _IDENTIFIER.fullmatch(part) is None:
            snake = re.sub(r"[^A-Za-z0-9]+", "_", part).strip("_")
            hint = (
                f"did you mean `{name[:start]}{snake}{name[end:]}`? " if _IDENTIFIER.fullmatch(snake) else ""
            )
            advice = (
                f"{hint}Each part of the name becomes an attribute in Python: letters, digits, underscores"
            )
            return BadName(f"`{part}` is not a valid part of a parameter's name", start, end, advice)
        if keyword.iskeyword(part) or part in _OF_CLASSES or (part.startswith("__") and part.endswith("__")):
            return BadName(f"`{part}` cannot be an attribute in Python", start, end, "choose another word")
        if part.startswith("__"):
            reason = f"`{part}` is private in Python, which gives it another name in each class"
            return BadName(reason, start, end, f"write `{part.lstrip('_') or 'private'}`, or one `_`")
        start = end + 1
    return None


def reserved_parameter(name: str) -> bool:
    """Whether rclpy itself declares a parameter of this name."""
    return name in {"use_sim_time", "start_type_description_service"} or name.startswith("qos_overrides.")


def class_name(node: str) -> str:
    """The name of a node's class: `GaitPlanner` for `gait_planner`."""
    camel = "".join(word[:1].upper() + word[1:] for word in node.split("_"))
    return camel if camel[:1].isalpha() else f"Node{camel}"
