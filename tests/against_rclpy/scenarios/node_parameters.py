"""Parameters: declaring, reading, setting, ranges, descriptors, callbacks, events; and the Parameter class."""

from __future__ import annotations

import array
import warnings
from typing import Any

import numpy as np
import rclpy
from rcl_interfaces.msg import (
    FloatingPointRange,
    IntegerRange,
    ParameterDescriptor,
    ParameterEvent,
    ParameterValue,
    SetParametersResult,
)
from rcl_interfaces.msg import Parameter as ParameterMsg
from rclpy.node import Node
from rclpy.parameter import Parameter, get_parameter_value, parameter_value_to_python
from transcript import attempt, until

T = Parameter.Type


def show(thing: Any) -> Any:
    """Parameters, results and descriptors without addresses."""
    match thing:
        case Parameter():
            return (thing.name, thing.type_.name, thing.value)
        case SetParametersResult():
            return (thing.successful, thing.reason)
        case ParameterDescriptor():
            return (thing.name, thing.type, thing.description, thing.read_only, thing.dynamic_typing)
        case ParameterValue():
            return (thing.type, parameter_value_to_python(thing))
        case list() | tuple():
            return [show(each) for each in thing]
        case dict():
            return {key: show(each) for key, each in thing.items()}
    return thing


def of_the_class() -> None:
    """Inference, checks, messages, YAML."""
    values: list[Any] = [
        None, True, 1, 1.0, "a", [], [True], [1], [1.0], ["a"], [b"a"], [b"ab"], (1, 2), array.array("i", [1]), array.array("d", [1.0]),
        b"a", {}, [1, "a"], [1, 1.0], [True, 1], np.int64(1), np.float64(1), object, 2**70,
    ]  # fmt: skip
    for value in values:
        attempt(f"infer {value!r}", lambda value=value: T.from_parameter_value(value))
        attempt(f"make {value!r}", lambda value=value: Parameter("p", value=value), show)
        attempt(f"checks {value!r}", lambda value=value: [each.name for each in T if each.check(value)])
        attempt(
            f"message {value!r}",
            lambda value=value: Parameter.from_parameter_msg(Parameter("p", value=value).to_parameter_msg()),
            show,
        )
    attempt("numpy", lambda: Parameter("p", value=np.array([1, 2])), show)
    attempt("disagree", lambda: Parameter("p", T.DOUBLE, 1))
    attempt("type", lambda: Parameter("p", 2, 1))
    attempt("unequal", lambda: Parameter("p", value=1) == Parameter("p", value=1))
    attempt("types", lambda: [(each.name, each.value) for each in T])
    attempt("read only", lambda: setattr(Parameter("p", value=1), "value", 2))
    for text in (
        "1", "1.0", "true", "yes", "a", "", "~", "null", "[1, 2]", "[1.0,2]", "[1,a]", "[a, b]", "[true]", "[]", "'1'", "{a: 1}",
        "a: 1", "[1", "1e3", "0x10", "2001-01-01", "a b", "[[1]]", "1_000", ".5",
    ):  # fmt: skip
        attempt(f"yaml {text}", lambda text=text: show(get_parameter_value(text)))
    attempt("bad type", lambda: parameter_value_to_python(ParameterValue(type=77)))


def declaring(node: Node) -> None:
    """Forms of declarations and their errors."""
    declare = node.declare_parameter
    attempt("int", lambda: declare("i", 1), show)
    attempt("twice", lambda: declare("i", 1))
    attempt("empty", lambda: declare("", 1))
    attempt("type only", lambda: declare("t", T.INTEGER), show)
    attempt("get unset", lambda: node.get_parameter("t"))
    attempt("or", lambda: node.get_parameter_or("t"), show)
    attempt("or", lambda: node.get_parameter_or("t", Parameter("z", value=3)), show)
    attempt("set it", lambda: node.set_parameters([Parameter("t", value=3)]), show)
    attempt("not set type", lambda: declare("x", T.NOT_SET))
    attempt("none", lambda: declare("x", None, ParameterDescriptor()))
    attempt("dynamic", lambda: declare("d", None, ParameterDescriptor(dynamic_typing=True)), show)
    attempt("dynamic type", lambda: declare("x", T.BOOL, ParameterDescriptor(dynamic_typing=True)))
    attempt("message", lambda: declare("m", ParameterValue(type=2, integer_value=4)))
    attempt("bad value", lambda: declare("x", {}))
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        attempt("name only", lambda: declare("only"), show)
        print([(each.category.__name__, str(each.message)) for each in caught])
    attempt(
        "many",
        lambda: node.declare_parameters("ns", [("a", 1), ("b", T.STRING), ("c", 2.0, ParameterDescriptor())]),
        show,
    )
    attempt("again", lambda: node.declare_parameters("ns", [("a", 1), ("z", 2)]))
    attempt("length", lambda: node.declare_parameters("", [()]))
    attempt("length", lambda: node.declare_parameters("", [(1, 2, 3, 4)]))
    attempt("no name", lambda: node.declare_parameters("", [(1, 2)]))
    attempt("no descriptor", lambda: node.declare_parameters("", [("q", 2, 3)]))
    attempt("override", lambda: declare("over", 1), show)
    attempt("ignored", lambda: declare("over2", 1, ignore_override=True), show)
    attempt("other type", lambda: declare("over3", 1))
    attempt("declared?", lambda: node.has_parameter("over3"))
    attempt("ro", lambda: declare("ro", 1, ParameterDescriptor(read_only=True, description="no")), show)
    attempt("set ro", lambda: node.set_parameters([Parameter("ro", value=2)]), show)
    attempt("undeclare ro", lambda: node.undeclare_parameter("ro"))
    attempt("undeclare", lambda: node.undeclare_parameter("m"))
    attempt("undeclare", lambda: node.undeclare_parameter("zz"))
    attempt("undeclare", lambda: node.undeclare_parameter("i"))
    attempt("has", lambda: node.has_parameter("i"))
    attempt("declare", lambda: declare("i", 7), show)


def reading(node: Node) -> None:
    """All ways to read."""
    for call in (node.get_parameter, node.get_parameter_type, node.describe_parameter):
        attempt(call.__name__, lambda call=call: call("i"), show)
        attempt(call.__name__, lambda call=call: call("zz"), show)
    for calls in (node.get_parameters, node.get_parameter_types, node.describe_parameters):
        attempt(calls.__name__, lambda calls=calls: calls(["i", "d"]), show)
        attempt(calls.__name__, lambda calls=calls: calls(["i", "zz"]), show)
    attempt("names", lambda: node.get_parameters([1]))
    attempt("types", lambda: node.get_parameter_types([1]))
    for prefix in ("", "ns", "n", "ns.a", "zz"):
        attempt(f"prefix {prefix}", lambda prefix=prefix: node.get_parameters_by_prefix(prefix), show)
    for prefixes, depth in (
        ([], 0),
        ([], 1),
        ([], 2),
        (["ns"], 0),
        (["ns"], 1),
        (["ns", "i"], 2),
        (["zz"], 0),
    ):
        attempt(
            f"list {prefixes} {depth}",
            lambda prefixes=prefixes, depth=depth: node.list_parameters(prefixes, depth),
            lambda result: (list(result.names), list(result.prefixes)),
        )
    for arguments in (([], -1), ("x", 1), ([1], 1), ([], "a")):
        attempt(f"list {arguments}", lambda arguments=arguments: node.list_parameters(*arguments))


def setting(node: Node) -> None:
    """Types, ranges, descriptors."""
    put = node.set_parameters
    attempt("type", lambda: put([Parameter("i", value="s")]), show)
    attempt("unset", lambda: put([Parameter("i")]), show)
    attempt("dynamic", lambda: put([Parameter("d", value=1), Parameter("d", value="s")]), show)
    attempt("dynamic unset", lambda: put([Parameter("d")]), show)
    attempt("gone", lambda: node.has_parameter("d"))
    attempt("unknown", lambda: node.set_parameters_atomically([Parameter("i", value=5)]), show)
    attempt("none", lambda: node.set_parameters_atomically([]), show)
    attempt("no parameter", lambda: put([1]))
    node.declare_parameter(
        "r", 2, ParameterDescriptor(integer_range=[IntegerRange(from_value=0, to_value=9, step=2)])
    )
    node.declare_parameter(
        "f",
        0.9,
        ParameterDescriptor(
            floating_point_range=[FloatingPointRange(from_value=0.0, to_value=2.0, step=0.3)]
        ),
    )
    node.declare_parameter(
        "back", 1, ParameterDescriptor(integer_range=[IntegerRange(from_value=5, to_value=1)])
    )
    for value in (0, 4, 5, 9, 10, -1, 8):
        attempt(f"r {value}", lambda value=value: put([Parameter("r", value=value)]), show)
        attempt(f"back {value}", lambda value=value: put([Parameter("back", value=value)]), show)
    for number in (0.0, 0.3, 0.31, 0.30000001, 2.0, 2.1, -0.1, 1.9, 1.8, 2.0000001):
        attempt(f"f {number}", lambda number=number: put([Parameter("f", value=number)]), show)
    attempt(
        "out of range",
        lambda: node.declare_parameter(
            "r2", 20, ParameterDescriptor(integer_range=[IntegerRange(from_value=0, to_value=9)])
        ),
    )
    attempt("set_descriptor", lambda: node.set_descriptor("i", ParameterDescriptor(description="x")))
    attempt(
        "set_descriptor",
        lambda: node.set_descriptor(
            "i",
            ParameterDescriptor(
                type=2, description="x", integer_range=[IntegerRange(from_value=8, to_value=9)]
            ),
        ),
    )
    attempt(
        "set_descriptor",
        lambda: node.set_descriptor(
            "i",
            ParameterDescriptor(type=2, integer_range=[IntegerRange(from_value=8, to_value=9)]),
            ParameterValue(type=2, integer_value=9),
        ),
        show,
    )
    attempt(
        "set_descriptor", lambda: node.set_descriptor("i", ParameterDescriptor(dynamic_typing=True)), show
    )
    attempt("described", lambda: node.describe_parameter("i"), show)
    attempt("set_descriptor", lambda: node.set_descriptor("zz", ParameterDescriptor()))
    attempt("set_descriptor", lambda: node.set_descriptor("ro", ParameterDescriptor()))
    attempt("tolerance", lambda: Node.PARAM_REL_TOL)


def callbacks(node: Node) -> None:
    """Order, refusal, changes by callbacks, wrong results."""
    calls: list[Any] = []

    def answer(name: str, successful: bool) -> Any:
        def on_set(parameters: list[Parameter]) -> SetParametersResult:
            calls.append((name, show(parameters)))
            return SetParametersResult(successful=successful, reason=name)

        return on_set

    first, second, refuse = answer("first", True), answer("second", True), answer("refuse", False)

    def pre(parameters: list[Parameter]) -> list[Parameter]:
        calls.append(("pre", show(parameters)))
        return [*parameters, Parameter("ns.a", value=99)]

    def drop(parameters: list[Parameter]) -> list[Parameter]:
        return []

    def post(parameters: list[Parameter]) -> None:
        calls.append(("post", show(parameters)))

    node.add_on_set_parameters_callback(first)
    node.add_on_set_parameters_callback(second)
    node.add_post_set_parameters_callback(post)
    attempt("set", lambda: node.set_parameters([Parameter("r", value=2)]), show)
    node.add_pre_set_parameters_callback(pre)
    attempt("with pre", lambda: node.set_parameters([Parameter("r", value=4)]), show)
    attempt(
        "atomic",
        lambda: node.set_parameters_atomically([Parameter("r", value=6), Parameter("f", value=0.0)]),
        show,
    )
    attempt("declare", lambda: node.declare_parameter("cb", 1), show)
    node.add_on_set_parameters_callback(refuse)
    attempt("refused", lambda: node.set_parameters([Parameter("r", value=8)]), show)
    attempt("value", lambda: node.get_parameter("r"), show)
    attempt("declare refused", lambda: node.declare_parameter("cb2", 1))
    node.remove_on_set_parameters_callback(refuse)
    attempt("again", lambda: node.remove_on_set_parameters_callback(refuse))
    attempt("pre", lambda: node.remove_pre_set_parameters_callback(drop))
    node.remove_pre_set_parameters_callback(pre)
    node.add_pre_set_parameters_callback(drop)
    attempt("dropped", lambda: node.set_parameters([Parameter("r", value=8)]), show)
    node.remove_pre_set_parameters_callback(drop)
    node.remove_post_set_parameters_callback(post)
    attempt("post", lambda: node.remove_post_set_parameters_callback(post))
    node.add_on_set_parameters_callback(lambda _: True)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        attempt("wrong answer", lambda: node.set_parameters([Parameter("r", value=8)]), show)
        print([str(each.message) for each in caught])
    attempt("not callable", lambda: node.add_on_set_parameters_callback(1))
    attempt("not callable", lambda: node.add_post_set_parameters_callback(1))
    for call in calls:
        print(call)


def undeclared(context: Any) -> None:
    """A node that allows undeclared parameters."""
    node = rclpy.create_node(
        "anything",
        context=context,
        allow_undeclared_parameters=True,
        automatically_declare_parameters_from_overrides=True,
        parameter_overrides=[Parameter("o", value=1), Parameter("p.q", value=[1, 2])],
    )
    attempt("listed", lambda: node.get_parameters_by_prefix(""), show)
    attempt("get", lambda: node.get_parameter("zz"), show)
    attempt("type", lambda: node.get_parameter_type("zz"))
    attempt("describe", lambda: node.describe_parameter("zz"), show)
    attempt("set", lambda: node.set_parameters([Parameter("zz", value=1)]), show)
    attempt("describe", lambda: node.describe_parameter("zz"), show)
    attempt(
        "set",
        lambda: node.set_parameters([Parameter("zz", value="s"), Parameter("zz"), Parameter("yy")]),
        show,
    )
    attempt("has", lambda: node.has_parameter("zz"))
    attempt("undeclare", lambda: node.undeclare_parameter("zz"))
    attempt("descriptor", lambda: node.set_descriptor("zz", ParameterDescriptor()), show)
    attempt("o", lambda: node.set_parameters([Parameter("o", value="s")]), show)
    attempt("o", lambda: node.describe_parameter("o"), show)
    node.destroy_node()


def events() -> None:
    """The messages on /parameter_events."""
    listener = rclpy.create_node("listener")
    heard: list[ParameterEvent] = []
    listener.create_subscription(ParameterEvent, "/parameter_events", heard.append, 100)
    until(lambda: listener.count_publishers("/parameter_events") == 1, listener)
    node = rclpy.create_node("eventful", namespace="/deep/ns")
    until(lambda: node.count_subscribers("/parameter_events") == 1, listener)
    until(lambda: next(node.publishers).get_subscription_count() == 1, listener)
    node.declare_parameter("i", 1)
    node.set_parameters([Parameter("i", value=1)])
    node.set_parameters([Parameter("i", value=2)])
    node.declare_parameter("d", "a", ParameterDescriptor(dynamic_typing=True))
    node.set_parameters_atomically([Parameter("d"), Parameter("i", value=5)])
    node.declare_parameter("u", 1.5)
    node.undeclare_parameter("u")
    node.set_parameters([Parameter("i", value="refused")])
    node.declare_parameter("last", True)

    def names(parameters: list[ParameterMsg]) -> list[Any]:
        return [(each.name, parameter_value_to_python(each.value)) for each in parameters]

    print(until(lambda: any("last" in [p.name for p in event.new_parameters] for event in heard), listener))
    for event in heard:
        if any(
            each.name in ("use_sim_time", "start_type_description_service") for each in event.new_parameters
        ):
            continue
        new, changed, deleted = map(
            names, (event.new_parameters, event.changed_parameters, event.deleted_parameters)
        )
        print(event.node, new, changed, deleted, event.stamp.sec > 0)
    node.destroy_node()
    listener.destroy_node()


def main() -> None:
    """Print all of it."""
    rclpy.init(args=["--ros-args", "-p", "over:=5", "-p", "over2:=5", "-p", "over3:=s"])
    node = rclpy.create_node("parameters")
    of_the_class()
    declaring(node)
    reading(node)
    setting(node)
    callbacks(node)
    undeclared(node.context)
    node.destroy_node()
    attempt("after destruction", lambda: node.get_parameter("i"), show)
    attempt("after destruction", lambda: node.set_parameters([Parameter("i", value=1)]))
    events()
    rclpy.shutdown()
