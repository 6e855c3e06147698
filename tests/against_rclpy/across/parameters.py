"""Parameters of a node in another process: its six services, its events, and its description of types."""

import tempfile
from pathlib import Path

from rcl_interfaces.msg import (
    FloatingPointRange,
    ParameterDescriptor,
    ParameterEvent,
    ParameterType,
    SetParametersResult,
)
from rcl_interfaces.srv import ListParameters
from rclpy.parameter import Parameter, parameter_value_to_python
from rclpy.parameter_client import AsyncParameterClient
from rclpy.parameter_event_handler import ParameterEventHandler
from stage import Stage
from type_description_interfaces.srv import GetTypeDescription


def owner(stage: Stage) -> None:
    """Has parameters."""
    node = stage.node("owner", namespace="/here")
    rate = ParameterDescriptor(
        description="how often", floating_point_range=[FloatingPointRange(from_value=0.0, to_value=10.0)]
    )
    node.declare_parameter("rate", 0.1, rate)
    node.declare_parameter("names", ["a", "b"])
    node.declare_parameter("camera.width", 640)
    node.declare_parameter("camera.lens.width", 0.1)
    node.declare_parameter("fixed", True, ParameterDescriptor(read_only=True))

    def judge(parameters):
        is_good = all(
            parameter.name != "camera.width" or parameter.value % 2 == 0 for parameter in parameters
        )
        return SetParametersResult(successful=is_good, reason="" if is_good else "must be even")

    node.add_on_set_parameters_callback(judge)
    stage.meet()
    stage.meet()
    stage.meet()
    stage.say([(name, node.get_parameter(name).value) for name in ("rate", "camera.width", "fixed")])
    stage.say(list(node.get_parameter("names").value))
    node.set_parameters([Parameter("rate", value=9.75)])
    stage.meet()


def reader(stage: Stage) -> None:
    """Reads and sets them."""
    stage.meet()
    node = stage.node("reader")
    events, handled = [], []
    node.create_subscription(ParameterEvent, "/parameter_events", events.append, 50)
    handler = ParameterEventHandler(node)
    handler.add_parameter_callback(
        "rate", "/here/owner", lambda parameter: handled.append(parameter_value_to_python(parameter.value))
    )
    client = AsyncParameterClient(node, "/here/owner")
    stage.until(client.services_are_ready)
    stage.meet()
    stage.until(lambda: node.count_publishers("/parameter_events") == 2)
    stage.spin(0.3)

    def values(names):
        return [
            parameter_value_to_python(value) for value in stage.result(client.get_parameters(names)).values
        ]

    stage.say(values(["rate", "fixed", "camera.width", "unknown"]))
    stage.say(list(stage.result(client.get_parameter_types(["rate", "names", "unknown"])).types))
    (described,) = stage.result(client.describe_parameters(["rate"])).descriptors
    stage.say(described.name, described.type == ParameterType.PARAMETER_DOUBLE, described.description)
    stage.say(described.floating_point_range[0].to_value, described.read_only)
    for prefixes, depth in (([], 0), (["camera"], 1), (["camera"], 2), (["none"], 0)):
        listed = stage.result(client.list_parameters(prefixes, depth)).result
        stage.say(prefixes, depth, sorted(listed.names), sorted(listed.prefixes))
    for changes in (
        {"rate": 2.5},
        {"rate": 11.0},
        {"rate": "text"},
        {"fixed": False},
        {"camera.width": 3},
        {"new": 1},
    ):
        parameters = [Parameter(name, value=value) for name, value in changes.items()]
        (result,) = stage.result(client.set_parameters(parameters)).results
        # Upstream's text about a name that was not declared has an empty list where ours names it.
        stage.say(changes, result.successful, result.reason.partition("undeclared")[0])
    for width in (7, 8):
        both = [Parameter("rate", value=width / 2), Parameter("camera.width", value=width)]
        result = stage.result(client.set_parameters_atomically(both)).result
        stage.say(width, result.successful, result.reason, values(["rate"]))
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder, "new.yaml")
        file.write_text("/here/owner:\n  ros__parameters:\n    rate: 7.5\n    names: [c]\n")
        loaded = stage.result(client.load_parameter_file(str(file)))
        stage.say([result.successful for result in loaded.results])
    stage.until(lambda: handled[-1:] == [7.5], "an event")
    stage.say(handled)
    (result,) = stage.result(client.delete_parameters(["names"])).results
    stage.say("delete", result.successful, result.reason)
    own = [event for event in events if event.node == "/here/owner"]
    stage.say([[change.name for change in event.changed_parameters] for event in own])
    describing = node.create_client(GetTypeDescription, "/here/owner/get_type_description")
    stage.until(describing.service_is_ready)
    (info,) = [
        info for info in node.get_publishers_info_by_topic("/parameter_events") if info.node_name == "owner"
    ]
    question = GetTypeDescription.Request(type_name=info.topic_type, type_hash=str(info.topic_type_hash))
    answer = stage.result(describing.call_async(question))
    stage.say(answer.successful, answer.type_description.type_description.type_name)
    listing = node.create_client(ListParameters, "/here/owner/list_parameters")
    stage.until(listing.service_is_ready)
    stage.say(len(stage.result(listing.call_async(ListParameters.Request())).result.names))
    stage.meet()
    stage.until(lambda: handled[-1:] == [9.75], "an event")
    stage.meet()


ROLES = {
    "owner": owner,
    "reader": reader,
}
