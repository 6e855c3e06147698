"""Nodes in `rosgraph_msgs/msg/Node` messages, as `ros2 topic echo` and nodl_observe write them in YAML.

The package has these messages in ROS 2 Rolling, and the form of actions has changed there: both are read.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, Final

import yaml
from ifgen.diagnostics import Diagnostic, Label, Span, UsageError
from ifgen.nodl.model import Category, QosProfile
from ifgen.reading.storage import read_source

from ifgen_tools.nodl.parameters import TYPES, RunningParameter
from ifgen_tools.param.client import FIELDS
from ifgen_tools.ros_graph import Endpoint

# A number that is not here stands for a policy that nobody could see.
_HISTORY: Final = {1: "KEEP_LAST", 2: "KEEP_ALL"}
_RELIABILITY: Final = {1: "RELIABLE", 2: "BEST_EFFORT", 4: "BEST_AVAILABLE"}
_DURABILITY: Final = {1: "TRANSIENT_LOCAL", 2: "VOLATILE", 4: "BEST_AVAILABLE"}
_LIVELINESS: Final = {1: "AUTOMATIC", 3: "MANUAL_BY_TOPIC", 5: "BEST_AVAILABLE"}
_INFINITE: Final = 2**31 - 1  # seconds
_PART: Final = re.compile(r"(_SendGoal)?_(Request|Response)$|_FeedbackMessage$")


def read_node(path: Path) -> tuple[str, list[Endpoint], list[RunningParameter]]:
    """The full name, the endpoints and the parameters of the one node in a file. Raises UsageError."""
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
