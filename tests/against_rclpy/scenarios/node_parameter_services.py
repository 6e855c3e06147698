"""Parameters of another node: the client, the services below it, the event handler, files."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import Any

import rclpy
from rcl_interfaces.msg import Parameter as ParameterMsg
from rcl_interfaces.msg import ParameterDescriptor, ParameterEvent
from rcl_interfaces.srv import ListParameters
from rclpy.executors import SingleThreadedExecutor
from rclpy.parameter import Parameter, parameter_dict_from_yaml_file, parameter_value_to_python
from rclpy.parameter_client import AsyncParameterClient
from rclpy.parameter_event_handler import ParameterEventHandler
from transcript import attempt, until

FILE = """
/**:
  ros__parameters:
    a: 5
    wild: true
target:
  ros__parameters:
    a: 7
    deep:
      b: [1.5, 2.5]
      c: text
"""


def value(parameter: ParameterMsg) -> Any:
    """Name and value."""
    return parameter.name, parameter_value_to_python(parameter.value)


def results(answer: Any) -> Any:
    """For each parameter, whether it was set, and why not."""
    return [(each.successful, each.reason) for each in answer.results]


class Asker:
    """A node that asks the node `target` for its parameters."""

    def __init__(self, executor: SingleThreadedExecutor, node: Any) -> None:
        self.executor = executor
        self.node = node
        self.client = AsyncParameterClient(node, "target")

    def done(self, future: Any) -> Any:
        """Spin until the answer has arrived."""
        self.executor.spin_until_future_complete(future, 10.0)
        return future.result()

    def waiting(self) -> None:
        """Wait for the services of a node that exists, and of one that does not."""
        attempt("wait", lambda: self.client.wait_for_services(10.0))
        attempt("ready", self.client.services_are_ready)
        missing = AsyncParameterClient(self.node, "nobody")
        attempt(
            "missing",
            lambda: (
                missing.services_are_ready(),
                missing.wait_for_services(0.0),
                missing.wait_for_services(0.1),
            ),
        )

    def getting(self) -> None:
        """Get values, types and descriptions."""
        client, done = self.client, self.done
        calls: list[Any] = []

        def values(names: list[str]) -> Any:
            return [parameter_value_to_python(each) for each in done(client.get_parameters(names)).values]

        def descriptions(names: list[str]) -> Any:
            return [
                (each.name, each.type, each.description, each.read_only)
                for each in done(client.describe_parameters(names)).descriptors
            ]

        attempt("get", lambda: values(["a", "deep.b"]))
        attempt("get callback", lambda: done(client.get_parameters(["a"], calls.append)) and len(calls))
        attempt("get unknown", lambda: list(done(client.get_parameters(["a", "zz"])).values))
        attempt("get unset", lambda: list(done(client.get_parameters(["unset"])).values))
        attempt("types", lambda: list(done(client.get_parameter_types(["a", "deep.b", "deep.c"])).types))
        attempt("types unknown", lambda: list(done(client.get_parameter_types(["zz"])).types))
        attempt("describe", lambda: descriptions(["a", "ro"]))
        attempt("describe unknown", lambda: list(done(client.describe_parameters(["a", "zz"])).descriptors))

    def setting(self) -> None:
        """Set parameters one by one and all at once, and delete them."""

        def each_set(*parameters: Any) -> Any:
            return results(self.done(self.client.set_parameters(list(parameters))))

        def all_set(*parameters: Parameter) -> Any:
            result = self.done(self.client.set_parameters_atomically(list(parameters))).result
            return result.successful, result.reason

        attempt(
            "set", lambda: each_set(Parameter("a", value=2), Parameter("a", value="s").to_parameter_msg())
        )
        attempt("set ro", lambda: each_set(Parameter("ro", value=2)))
        attempt("set unknown", lambda: each_set(Parameter("zz", value=2))[0][0])
        attempt("atomic", lambda: all_set(Parameter("a", value=3), Parameter("deep.c", value=1)))
        attempt("atomic", lambda: all_set(Parameter("a", value=3), Parameter("deep.c", value="x")))
        attempt("delete", lambda: results(self.done(self.client.delete_parameters(["a", "dynamic"]))))

    def listing(self) -> None:
        """List names and prefixes to any depth."""

        def listed(arguments: Any) -> Any:
            result = self.done(self.client.list_parameters(*arguments)).result
            return sorted(result.names), sorted(result.prefixes)

        for arguments in ((), (["deep"],), (["deep"], 1), ([], 1), (["zz"], 0), (None, 2)):
            attempt(f"list {arguments}", lambda arguments=arguments: listed(arguments))
        lister = self.node.create_client(ListParameters, "target/list_parameters")
        request = ListParameters.Request(depth=0)
        attempt("depth 0", lambda: len(self.done(lister.call_async(request)).result.names))

    def loading(self, path: Path) -> None:
        """Set parameters from a file, with and without wildcards."""

        def one_by_one(wild: bool) -> Any:
            return results(self.done(self.client.load_parameter_file(str(path), wild)))[0]

        def atomically(wild: bool) -> Any:
            return self.done(self.client.load_parameter_file_atomically(str(path), wild)).result.successful

        path.write_text(FILE)
        for wild in (False, True):
            attempt("load", lambda wild=wild: one_by_one(wild))
            attempt("atomically", lambda wild=wild: atomically(wild))
            attempt("dict", lambda wild=wild: values_of_file(path, wild))


def values_of_file(path: Path, *arguments: Any) -> Any:
    """Names and values that a file sets."""
    return [value(each) for each in parameter_dict_from_yaml_file(str(path), *arguments).values()]


def files(path: Path) -> None:
    """Read a file for one node, for another one, and files that cannot be read."""
    attempt("target", lambda: list(parameter_dict_from_yaml_file(str(path), False, ["target"], "n.")))
    attempt("both", lambda: values_of_file(path, True, ["target"]))
    attempt("unknown", lambda: parameter_dict_from_yaml_file(str(path), False, ["zz"]))
    path.write_text("/**: {ros__parameters: {a: 1}}\n")
    attempt("nothing", lambda: parameter_dict_from_yaml_file(str(path), False))
    path.write_text("n: {a: 1}\n")
    attempt("no parameters", lambda: parameter_dict_from_yaml_file(str(path), False))
    attempt("no file", lambda: parameter_dict_from_yaml_file("/nope.yaml"))


def remote(executor: SingleThreadedExecutor, node: Any) -> None:
    """Try every operation of the client."""
    asker = Asker(executor, node)
    asker.waiting()
    asker.getting()
    asker.setting()
    asker.listing()
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "p.yaml")
        asker.loading(path)
        files(path)


def handler(executor: SingleThreadedExecutor, node: Any, target: Any) -> None:
    """Callbacks by parameter, for everything, and their removal."""
    watch = ParameterEventHandler(node)
    print(until(lambda: target.count_subscribers("/parameter_events") == 1, executor))
    print(until(lambda: next(target.publishers).get_subscription_count() == 1, executor))
    calls: list[Any] = []
    first = watch.add_parameter_callback(
        "a", "target", lambda parameter: calls.append(("first", value(parameter)))
    )
    watch.add_parameter_callback("a", "/target", lambda parameter: calls.append(("second", value(parameter))))
    watch.add_parameter_callback("own", "", lambda parameter: calls.append(("own", value(parameter))))
    watch.add_parameter_callback("a", "other", lambda parameter: calls.append(("other", value(parameter))))
    every = watch.add_parameter_event_callback(lambda event: calls.append(("event", event.node)))
    watch.add_parameter_event_callback(lambda event: calls.append(("newest", event.node)))
    target.set_parameters([Parameter("a", value=11)])
    print(until(lambda: len(calls) == 4, executor), calls)
    calls.clear()
    node.declare_parameter("own", 1)
    print(until(lambda: len(calls) == 3, executor), calls)
    calls.clear()
    watch.remove_parameter_callback(first)
    watch.remove_parameter_event_callback(every)
    attempt("again", lambda: watch.remove_parameter_callback(first))
    attempt("again", lambda: watch.remove_parameter_event_callback(every))
    target.set_parameters([Parameter("a", value=12)])
    print(until(lambda: len(calls) == 2, executor), calls)
    event = ParameterEvent(
        node="/n", new_parameters=[ParameterMsg(name="x")], changed_parameters=[ParameterMsg(name="y")]
    )
    attempt(
        "get",
        lambda: [
            ParameterEventHandler.get_parameter_from_event(event, name, "/n") is not None for name in "xyz"
        ],
    )
    attempt("get", lambda: ParameterEventHandler.get_parameter_from_event(event, "x", "/m"))
    attempt("all", lambda: [each.name for each in ParameterEventHandler.get_parameters_from_event(event)])
    for path in ("", None, "x", "/x", "a/b"):
        attempt(f"path {path}", lambda path=path: watch._resolve_path(path))
    watch.destroy()
    attempt("destroyed", lambda: len(list(node.subscriptions)))


def main() -> None:
    """Print all of it."""
    rclpy.init()
    target = rclpy.create_node("target")
    target.declare_parameters(
        "", [("a", 1), ("ro", 1, ParameterDescriptor(read_only=True, description="fixed"))]
    )
    target.declare_parameters("deep", [("b", [1.0, 2.0]), ("c", "text")])
    target.declare_parameter("unset", Parameter.Type.STRING)
    target.declare_parameter("dynamic", 1, ParameterDescriptor(dynamic_typing=True))
    node = rclpy.create_node("asker")
    executor = SingleThreadedExecutor()
    executor.add_node(target)
    executor.add_node(node)
    remote(executor, node)
    handler(executor, node, target)
    executor.shutdown()
    node.destroy_node()
    target.destroy_node()
    rclpy.shutdown()
