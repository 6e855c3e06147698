"""Classes of types: installed, generated, made of definitions that ifgen finds, or described by a node."""

from __future__ import annotations

from dataclasses import dataclass
from importlib import import_module
from typing import TYPE_CHECKING, Any, Final

from ifgen.command_kit.tool import Absent, ToolError, did_you_mean
from ifgen.diagnostics import InputError

if TYPE_CHECKING:
    from rclpy.node import Node

# Late imports: a type that is installed needs nothing of the toolkit.

_HASHED: Final = "RIHS01_"
_WITH_OPTION: Final = "name the folder that it is in with -I DIR"


@dataclass(frozen=True, slots=True)
class WireType:
    """The type of a topic as an endpoint on it says; the hash is None where it does not say."""

    name: str
    hash: str | None


def interface_class(name: str, kind: str = "msg") -> type[Any]:
    """The class of `pkg/msg/Name` or `pkg/Name`; `kind` is `msg`, `srv` or `action`.

    If nothing of that name is installed or generated, it is made of the definition among the configured
    interfaces or those that come with ifgen. Raises ToolError that names near types.
    """
    package, _, rest = name.partition("/")
    folder, _, short = rest.rpartition("/")
    if not package.isidentifier() or not short.isidentifier() or folder not in {"", kind}:
        raise ToolError(f"{name!r} names no type", f"write it as package/{kind}/Name")
    try:
        found = getattr(import_module(f"{package}.{kind}"), short, None)
    except ModuleNotFoundError as error:
        if error.name not in {package, f"{package}.{kind}"}:
            raise
        found = None
    return found if isinstance(found, type) else _of_definition(f"{package}/{kind}/{short}")


def message_name(written: str) -> str:
    """`pkg/msg/Name`, which may be written as `pkg/Name`."""
    return written.replace("/", "/msg/", 1) if written.count("/") == 1 else written


def topic_types(node: Node, topic: str) -> list[WireType]:
    """The types of a topic, one for each definition that is on it."""
    infos = (*node.get_publishers_info_by_topic(topic), *node.get_subscriptions_info_by_topic(topic))
    found: dict[WireType, None] = {}
    for info in infos:
        type_hash = str(info.topic_type_hash)
        found[WireType(info.topic_type, type_hash if type_hash.startswith(_HASHED) else None)] = None
    return list(found)


def topic_class(node: Node, topic: str, timeout: float = 5.0) -> type[Any]:
    """The class of the messages on a topic that is in the graph; `topic` is its full name.

    What is installed or generated will do if its hash is that of the topic. Else the description of the node
    that has the topic is asked for, up to `timeout` [s]. Raises ToolError if there is no such topic, if it
    has several types, or if nobody describes its type.
    """
    types = topic_types(node, topic)
    names = list(dict.fromkeys(type_.name for type_ in types))
    if not names:
        known = sorted(name for name, _ in node.get_topic_names_and_types())
        raise Absent(f"there is no topic {topic!r}", did_you_mean(topic, known) or "see `ifgen topic list`")
    if len(names) > 1:
        raise ToolError(
            f"the topic {topic!r} has more than one type: {', '.join(names)}", "name one after the topic"
        )
    return class_with_hash(node, topic, types[0], timeout)


def class_with_hash(node: Node, topic: str, wanted: WireType, timeout: float = 5.0) -> type[Any]:
    """The class of a topic's type, of exactly this definition if it has a hash. Raises ToolError."""
    refusal: ToolError | None = None
    try:
        cls = interface_class(wanted.name)
    except ToolError as error:
        refusal = error
    else:
        if wanted.hash is None or getattr(cls, "__type_hash__", wanted.hash) == wanted.hash:
            return cls
    from ifgen.dynamic import DescribeError, InputError, class_of

    from ifgen_tools.type_descriptions import describe

    try:
        return class_of(describe(node, topic, timeout=timeout, type_hash=wanted.hash))
    except DescribeError as error:
        text = str(refusal.message if refusal else f"another {wanted.name} is installed here")
        raise ToolError(f"{error}; and {text}") from None
    except InputError as error:
        raise ToolError(f"the description of {wanted.name} is wrong: {error}") from None


def _of_definition(name: str) -> type[Any]:
    """The class of a definition that ifgen finds. Raises ToolError if there is none."""
    from ifgen.config.settings import settle
    from ifgen.dynamic.making import make
    from ifgen.pipeline import lookup
    from ifgen.reading.packages import find_packages
    from ifgen.reading.search_path import SearchPath

    settings = settle(None, None, ())
    try:
        search = SearchPath(find_packages(settings.paths), settings.include)
        return make(*lookup.find_type(name, search))
    except InputError as error:
        first = error.diagnostics[0]
        # Tools have no -I: the settings of the folder say where interfaces are.
        help = (first.help or "").replace(_WITH_OPTION, "run this in the project that has it")
        raise ToolError(first.message, help) from None
