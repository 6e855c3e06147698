"""Parameters through their real services: refusals and reasons, changes made together, and their effects."""

import rclpy
from rcl_interfaces.msg import Parameter as ParameterMessage
from rcl_interfaces.msg import ParameterType
from rcl_interfaces.srv import DescribeParameters, GetParameters, SetParameters, SetParametersAtomically
from rclpy.parameter import Parameter
from robot._arm_parameters import ArmParameters, ParametersError
from robot.arm import Arm
from stage import Stage, say

Type = Parameter.Type

rclpy.init()


def start(**overrides: object) -> None:
    """Try to start a node; print what is wrong with its parameters."""
    given = [Parameter(name.replace("__", "."), value=value) for name, value in overrides.items()]
    try:
        Arm(parameter_overrides=given).destroy_node()
    except ParametersError as error:
        for line in str(error).splitlines():
            say("cannot start", line)


start()
start(names=[""], gain__p=11.0, mode="run", control__period=5.0, even=3, enabled=1)
start(names=["a", "b"])

changes: list[ArmParameters] = []


class Listening(Arm):
    """A node that records the changes of its parameters."""

    def on_parameters_changed(self, parameters: ArmParameters) -> None:
        """Record the change."""
        changes.append(parameters)


node = Listening(
    parameter_overrides=[Parameter("names", value=["x", "y", "z"]), Parameter("mode", value="walk")]
)
stage = Stage(node)
for name in (
    "names",
    "mode",
    "letters",
    "offsets",
    "steps",
    "code",
    "mask",
    "flags",
    "even",
    "enabled",
    "gain",
    "control",
):
    say("starts with", name, getattr(node.parameters, name))
say("frozen", node.parameters.__dataclass_params__.frozen, node.parameters.gain.__dataclass_params__.frozen)


def message(name: str, value: object, kind: Type) -> ParameterMessage:
    """A parameter as services expect it."""
    return Parameter(name, kind, value).to_parameter_msg()


def attempt(name: str, value: object, kind: Type) -> None:
    """Set a parameter through the service; print the result."""
    before = node.parameters
    request = SetParameters.Request(parameters=[message(name, value, kind)])
    [result] = stage.call(SetParameters, "arm/set_parameters", request).results
    say(
        "set",
        name,
        value,
        result.successful,
        result.reason.replace("Parameter.Type.", ""),
        node.parameters is before,
    )


for arguments in (
    ("gain.p", 0.0, Type.DOUBLE),
    ("gain.p", float("nan"), Type.DOUBLE),
    ("gain.p", 9.5, Type.DOUBLE),
    ("gain.p", 9, Type.INTEGER),
    ("gain.i", 1.5, Type.DOUBLE),
    ("gain.limits.max", 6, Type.INTEGER),
    ("gain.limits.max", -5, Type.INTEGER),
    ("control.period", 2.0, Type.DOUBLE),
    ("names", ["q"], Type.STRING_ARRAY),
    ("mode", "run", Type.STRING),
    ("letters", ["a", "d"], Type.STRING_ARRAY),
    ("letters", ["a", "b", "c"], Type.STRING_ARRAY),
    ("letters", [], Type.STRING_ARRAY),
    ("offsets", [0.1, 2.0], Type.DOUBLE_ARRAY),
    ("offsets", [0.0] * 5, Type.DOUBLE_ARRAY),
    ("offsets", [0.25] * 4, Type.DOUBLE_ARRAY),
    ("steps", [3, 10], Type.INTEGER_ARRAY),
    ("steps", [3, 9], Type.INTEGER_ARRAY),
    ("code", "ab", Type.STRING),
    ("mask", [b"\x07"], Type.BYTE_ARRAY),
    ("even", 7, Type.INTEGER),
    ("even", 4, Type.INTEGER),
    ("enabled", False, Type.BOOL),
):
    attempt(*arguments)
say("holds", node.parameters.steps, node.parameters.mask, node.parameters.letters, node.parameters.gain)

# All or nothing.
for period, mode in ((0.2, "run"), (0.2, "stand")):
    changes.clear()
    parameters = [message("control.period", period, Type.DOUBLE), message("mode", mode, Type.STRING)]
    request = SetParametersAtomically.Request(parameters=parameters)
    result = stage.call(SetParametersAtomically, "arm/set_parameters_atomically", request).result
    say(
        "together",
        result.successful,
        result.reason,
        node.parameters.control.period,
        node.parameters.mode,
        len(changes),
    )
say("timer follows", node.control_timer.timer_period_ns)

# The output of `ros2 param describe`.
names = ["gain.limits.max", "control.period", "names", "mode"]
for descriptor in stage.call(
    DescribeParameters, "arm/describe_parameters", DescribeParameters.Request(names=names)
).descriptors:
    ranges = [*descriptor.integer_range, *descriptor.floating_point_range]
    bounds = [(r.from_value, r.to_value) for r in ranges]
    say(
        "described",
        descriptor.name,
        descriptor.type,
        descriptor.description,
        descriptor.read_only,
        bounds,
        descriptor.additional_constraints,
    )
values = stage.call(
    GetParameters, "arm/get_parameters", GetParameters.Request(names=["steps", "mask"])
).values
say(
    "typed",
    [value.type for value in values]
    == [ParameterType.PARAMETER_INTEGER_ARRAY, ParameterType.PARAMETER_BYTE_ARRAY],
)
node.destroy_node()
stage.peer.destroy_node()
rclpy.shutdown()
