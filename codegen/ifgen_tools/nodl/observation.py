"""Nodes in `rosgraph_msgs/msg/Node` messages: read from YAML, bags and topics, and made of running nodes.

The package has these messages since 2.0.4 of Jazzy, and the form of actions has changed: both are read.
Where the package lacks them, their classes are made from the text here.
"""

from __future__ import annotations

import re
import time
from collections.abc import Iterable, Iterator, Mapping
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import yaml
from ifgen.diagnostics import Diagnostic, Label, Span, UsageError
from ifgen.nodl.model import Category, QosProfile
from ifgen.reading.storage import read_source

from ifgen_tools.nodl.parameters import TYPES, RunningParameter
from ifgen_tools.param.client import FIELDS
from ifgen_tools.ros_graph import Endpoint, View

if TYPE_CHECKING:
    from rcl_interfaces.msg import ParameterDescriptor, ParameterValue
    from rclpy.qos import QoSProfile

# Late imports: messages, and what reads bags, are found once the transport has been chosen.

TOPIC: Final = "/nodl/observed_node"
"""The topic of nodl_observe, where a late subscription gets the last message, too."""

GRAPH_TOPIC: Final = "/nodl/observed_graph"

# A number that is not here stands for a policy that nobody could see.
_HISTORY: Final = {1: "KEEP_LAST", 2: "KEEP_ALL"}
_RELIABILITY: Final = {1: "RELIABLE", 2: "BEST_EFFORT", 4: "BEST_AVAILABLE"}
_DURABILITY: Final = {1: "TRANSIENT_LOCAL", 2: "VOLATILE", 4: "BEST_AVAILABLE"}
_LIVELINESS: Final = {1: "AUTOMATIC", 3: "MANUAL_BY_TOPIC", 5: "BEST_AVAILABLE"}
_INFINITE: Final = 2**31 - 1  # seconds
_NODE: Final = "rosgraph_msgs/msg/Node"
_UNKNOWN: Final = {"history": 3, "reliability": 3, "durability": 3, "liveliness": 4}
_HIDDEN_ACTION: Final = "/_action/"
_TEXT: Final = """\
{line}
MSG: rosgraph_msgs/Graph
Node[] nodes
{line}
MSG: rosgraph_msgs/Node
string name
rcl_interfaces/ParameterDescriptor[] parameters
rcl_interfaces/ParameterValue[] parameter_values
Topic[] publishers
Topic[] subscriptions
Service[] service_clients
Service[] service_servers
Action[] action_clients
Action[] action_servers
{line}
MSG: rosgraph_msgs/Topic
string name
InterfaceType type
QoSProfile qos
{line}
MSG: rosgraph_msgs/Service
string name
InterfaceType request_type
QoSProfile request_qos
InterfaceType response_type
QoSProfile response_qos
{line}
MSG: rosgraph_msgs/Action
string name
Service send_goal
Service get_result
Service cancel_goal
Topic feedback
Topic status
{line}
MSG: rosgraph_msgs/InterfaceType
string name
TypeHash hash
{line}
MSG: rosgraph_msgs/TypeHash
uint8 version 1
uint8[32] value
{line}
MSG: rosgraph_msgs/QoSProfile
uint32 depth
builtin_interfaces/Duration deadline
builtin_interfaces/Duration lifespan
uint8 HISTORY_SYSTEM_DEFAULT=0
uint8 HISTORY_KEEP_LAST=1
uint8 HISTORY_KEEP_ALL=2
uint8 HISTORY_UNKNOWN=3
uint8 history
uint8 RELIABILITY_SYSTEM_DEFAULT=0
uint8 RELIABILITY_RELIABLE=1
uint8 RELIABILITY_BEST_EFFORT=2
uint8 RELIABILITY_UNKNOWN=3
uint8 RELIABILITY_BEST_AVAILABLE=4
uint8 reliability
uint8 DURABILITY_SYSTEM_DEFAULT=0
uint8 DURABILITY_TRANSIENT_LOCAL=1
uint8 DURABILITY_VOLATILE=2
uint8 DURABILITY_UNKNOWN=3
uint8 DURABILITY_BEST_AVAILABLE=4
uint8 durability
uint8 LIVELINESS_SYSTEM_DEFAULT=0
uint8 LIVELINESS_AUTOMATIC=1
uint8 LIVELINESS_MANUAL_BY_TOPIC=3
uint8 LIVELINESS_UNKNOWN=4
uint8 LIVELINESS_BEST_AVAILABLE=5
uint8 liveliness
builtin_interfaces/Duration liveliness_lease_duration
""".format(line="=" * 80)
_PART: Final = re.compile(r"(_SendGoal)?_(Request|Response)$|_FeedbackMessage$")


def read_node(path: Path) -> tuple[str, list[Endpoint], list[RunningParameter]]:
    """The full name, the endpoints and the parameters of the one node in a file. Raises UsageError.

    The file is YAML, or a bag with one message of this type.
    """
    if path.suffix in {".mcap", ".db3"} or path.is_dir():
        return _node(_of_bag(path))
    source = read_source(path)
    try:
        documents = [each for each in yaml.safe_load_all(source.text) if each is not None]
        [message] = documents  # `ros2 topic echo` ends each message with `---`
        return _node(message)
    except (yaml.YAMLError, ValueError, TypeError, KeyError, AttributeError, RecursionError) as error:
        what = " ".join(str(error).split())
        diagnostic = Diagnostic(
            "invalid-message",
            f"this is not one message of the type rosgraph_msgs/msg/Node: {what}",
            Label(Span(source, 0, 0)),
            help="write it with `ros2 topic echo --once /nodl/observed_node > FILE.yaml`",
        )
        raise UsageError([diagnostic]) from None


def message_class(name: str) -> type[Any]:
    """The class `rosgraph_msgs/msg/NAME`: that of the package, or one made from the text here."""
    try:
        installed = import_module("rosgraph_msgs.msg")
    except ImportError:
        installed = None
    if hasattr(installed, "Graph"):
        found: type[Any] = getattr(installed, name)
        return found
    from ifgen.dynamic.texts import class_from_text

    return class_from_text(f"rosgraph_msgs/msg/{name}", _TEXT)


def node_from(message: Any) -> tuple[str, list[Endpoint], list[RunningParameter]]:
    """The full name, the endpoints and the parameters in a message."""
    from ifgen_tools.texts.formats import plain
    from ifgen_tools.texts.style import WHOLE

    return _node(plain(message, WHOLE))


def node_message(
    name: str,
    view: View,
    parameters: Iterable[tuple[ParameterDescriptor, ParameterValue | None]] | None,
) -> Any:
    """The message about a node of this full name: all that was seen, what the framework makes included."""
    from rcl_interfaces.msg import ParameterValue

    known = list(parameters or ())
    message = message_class("Node")(name=name, parameters=[descriptor for descriptor, _ in known])
    message.parameter_values = [value or ParameterValue() for _, value in known]
    own = [each for each in view.endpoints if each.node == name]
    actions = {each.name for each in own if each.category.folder == "action"}
    parts = {(each.category, each.name): each for each in own}
    for category in Category:
        entries = getattr(message, category.value)
        for end in own:
            action, sign, _ = end.name.partition(_HIDDEN_ACTION)
            if end.category is category and not (sign and action in actions):
                entries.append(_entry(end, parts))
    return message


def graph_message(nodes: Iterable[Any]) -> Any:
    """The message about several nodes, from those about each of them."""
    return message_class("Graph")(nodes=list(nodes))


def latched() -> QoSProfile:
    """The profile of a topic whose late subscriptions get the last message."""
    from rclpy.qos import DurabilityPolicy, QoSProfile

    return QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)


def write(message: Any, topic: str, path: Path) -> None:
    """Write a message: into a bag with one topic, or as YAML. Raises BagError."""
    if path.suffix == ".mcap":
        from ifgen_runtime.bag import Recorder

        with Recorder(path, overwrite=True) as recorder:
            recorder.write(topic, message, time.time_ns())
        return
    from ifgen_tools.texts.formats import as_yaml

    path.write_text(f"{as_yaml(message).rstrip()}\n---\n", encoding="utf-8")


def _entry(end: Endpoint, parts: Mapping[tuple[Category, str], Endpoint]) -> Any:
    entry = message_class({"msg": "Topic", "srv": "Service", "action": "Action"}[end.category.folder])()
    entry.name = end.name
    if end.category.folder == "msg":
        _fill_topic(entry, end)
    elif end.category.folder == "srv":
        _fill_service(entry, end.type_name)
    elif hasattr(entry, "feedback_type"):  # the other form
        goal = f"{end.type_name}_SendGoal"
        entry.request_type.name, entry.response_type.name = f"{goal}_Request", f"{goal}_Response"
        entry.feedback_type.name = f"{end.type_name}_FeedbackMessage"
    else:
        hidden = f"{end.name}{_HIDDEN_ACTION}"
        services = {"send_goal": f"{end.type_name}_SendGoal", "get_result": f"{end.type_name}_GetResult"}
        for part, type_name in {**services, "cancel_goal": "action_msgs/srv/CancelGoal"}.items():
            service = getattr(entry, part)
            service.name = f"{hidden}{part}"
            _fill_service(service, type_name)
        is_server = end.category is Category.ACTION_SERVER
        of_topics = Category.PUBLISHER if is_server else Category.SUBSCRIPTION
        topics = {"feedback": f"{end.type_name}_FeedbackMessage", "status": "action_msgs/msg/GoalStatusArray"}
        for part, type_name in topics.items():
            topic = getattr(entry, part)
            topic.name = f"{hidden}{part}"
            seen = parts.get((of_topics, topic.name))
            _fill_topic(topic, seen or Endpoint(end.node, topic.name, of_topics, type_name))
    return entry


def _fill_topic(topic: Any, end: Endpoint) -> None:
    topic.type.name = end.type_name
    if end.type_hash:
        topic.type.hash.value = list(bytes.fromhex(end.type_hash.partition("_")[2]))
    _fill_qos(topic.qos, end.qos)


def _fill_service(service: Any, type_name: str) -> None:
    service.request_type.name, service.response_type.name = f"{type_name}_Request", f"{type_name}_Response"
    for qos in ("request_qos", "response_qos"):
        if hasattr(service, qos):  # one form has none
            _fill_qos(getattr(service, qos), None)


def _fill_qos(qos: Any, seen: QosProfile | None) -> None:
    numbers = {
        "history": _HISTORY,
        "reliability": _RELIABILITY,
        "durability": _DURABILITY,
        "liveliness": _LIVELINESS,
    }
    for policy, words in numbers.items():
        by_word = {word: number for number, word in words.items()}
        word = str(getattr(seen, policy, None))
        setattr(qos, policy, by_word.get(word, _UNKNOWN[policy]))
    if seen is None:
        return
    qos.depth = seen.depth
    for duration in ("deadline", "lifespan", "liveliness_lease_duration"):
        seconds, nanoseconds = divmod(getattr(seen, f"{duration}_ns"), 10**9)
        value = getattr(qos, duration)
        value.sec, value.nanosec = min(seconds, _INFINITE), nanoseconds


def _of_bag(path: Path) -> dict[str, Any]:
    from ifgen_runtime.bag import Bag, BagError

    from ifgen_tools.texts.formats import plain
    from ifgen_tools.texts.style import WHOLE

    try:
        with Bag(path) as bag:
            topics = [name for name, topic in bag.topics.items() if topic.type_name == _NODE]
            found: list[Any] = [message for name in topics for message in bag[name]]
    except BagError as error:
        raise UsageError([Diagnostic("invalid-message", str(error))]) from None
    if len(found) != 1:
        message = f"{path} has {len(found)} messages of the type rosgraph_msgs/msg/Node, not one"
        raise UsageError([Diagnostic("invalid-message", message, help="record one, or cut the bag")])
    read: dict[str, Any] = plain(found[0], WHOLE)
    return read


def _node(message: Mapping[str, Any]) -> tuple[str, list[Endpoint], list[RunningParameter]]:
    name = str(message["name"])
    ends = [end for category in Category for end in _endpoints(message, category, name)]
    descriptors = message.get("parameters") or []
    values = message.get("parameter_values") or []
    pairs = zip(descriptors, [*values, *[None] * (len(descriptors) - len(values))], strict=False)
    return name, ends, [_parameter(descriptor, value) for descriptor, value in pairs]


def _endpoints(message: Mapping[str, Any], category: Category, node: str) -> Iterator[Endpoint]:
    for each in message.get(category.value) or []:
        if category.folder == "msg":
            yield Endpoint(node, each["name"], category, each["type"]["name"], _qos(each["qos"]))
            continue
        whole = each.get("send_goal", each)
        yield Endpoint(node, each["name"], category, _PART.sub("", whole["request_type"]["name"]))


def _qos(qos: Mapping[str, Any]) -> QosProfile:
    history = _HISTORY.get(qos["history"], "SYSTEM_DEFAULT")
    profile: dict[str, Any] = {
        "history": history,
        "reliability": _RELIABILITY.get(qos["reliability"], "SYSTEM_DEFAULT"),
        "depth": int(qos["depth"]) if history == "KEEP_LAST" else 0,
        "durability": _DURABILITY.get(qos["durability"]),
        "liveliness": _LIVELINESS.get(qos["liveliness"]),
        "deadline_ns": _nanoseconds(qos["deadline"]),
        "lifespan_ns": _nanoseconds(qos["lifespan"]),
        "liveliness_lease_duration_ns": _nanoseconds(qos["liveliness_lease_duration"]),
    }
    return QosProfile(**profile)


def _nanoseconds(duration: Mapping[str, int]) -> int:
    seconds = int(duration["sec"])
    return 0 if seconds == _INFINITE else seconds * 10**9 + int(duration["nanosec"])


def _parameter(descriptor: Mapping[str, Any], value: Mapping[str, Any] | None) -> RunningParameter:
    type_ = int(value["type"]) if value else 0
    limits = [*descriptor.get("floating_point_range", ()), *descriptor.get("integer_range", ())]
    return RunningParameter(
        name=str(descriptor["name"]),
        type=TYPES.get(type_) or TYPES.get(int(descriptor.get("type", 0)), "none"),
        value=value[FIELDS[type_]] if value and type_ in FIELDS else None,
        description=str(descriptor.get("description", "")),
        read_only=bool(descriptor.get("read_only", False)),
        additional_constraints=str(descriptor.get("additional_constraints", "")),
        bounds=(limits[0]["from_value"], limits[0]["to_value"]) if limits else None,
        step=limits[0]["step"] if limits else 0,
    )
