"""The type description service, wait_for_message, wait sets and QoS overrides."""

import threading
import time

import rclpy
from geometry_msgs.msg import PoseStamped
from rcl_interfaces.msg import SetParametersResult
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import SingleThreadedExecutor
from rclpy.impl.implementation_singleton import rclpy_implementation as rcl
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.qos import QoSPolicyKind, QoSProfile
from rclpy.qos_overriding_options import QoSOverridingOptions
from rclpy.wait_for_message import wait_for_message
from rclpy.waitable import NumberOfEntities, Waitable
from std_msgs.msg import String
from std_srvs.srv import SetBool
from test_msgs.msg import Arrays, BoundedSequences, Empty, Strings
from transcript import attempt, spin_for, until
from type_description_interfaces.srv import GetTypeDescription


def type_descriptions(node: Node) -> None:
    """Types in use are described; others are not."""
    client = node.create_client(GetTypeDescription, "n/get_type_description")
    client.wait_for_service()

    def ask(name: str, type_hash: str, sources: bool = True) -> GetTypeDescription.Response:
        request = GetTypeDescription.Request(
            type_name=name, type_hash=type_hash, include_type_sources=sources
        )
        future = client.call_async(request)
        until(future.done, node)
        response = future.result()
        print(name, response.successful, response.failure_reason)
        return response

    node.create_service(SetBool, "set", print)
    for number, cls in enumerate((PoseStamped, Arrays, BoundedSequences, Strings, Empty)):
        node.create_publisher(cls, f"t{number}", 1)
        until(lambda number=number: node.get_publishers_info_by_topic(f"t{number}"))
        type_hash = str(node.get_publishers_info_by_topic(f"t{number}")[0].topic_type_hash)
        response = ask(cls.__name__, type_hash)
        print(response.type_description)
        print([(source.type_name, source.encoding) for source in response.type_sources])
        print(response.extra_information, ask("", type_hash, False).type_sources)
    response = ask("SetBool", "RIHS01_abe9e4bb6b41b40e6789712c00ec8871923e089af3f667a79992a428cff2da0a")
    print(response.type_description)
    print([(source.type_name, source.encoding) for source in response.type_sources])
    for type_hash in ("RIHS01_00", "RIHS01_" + "0" * 64, "", "RIHS02_" + "0" * 64, "x" * 71):
        ask("x", type_hash)


def waiting_for_a_message(node: Node) -> None:
    """One message, or the timeout."""
    print(wait_for_message(String, node, "one", time_to_wait=0.1))
    publisher = node.create_publisher(String, "one", QoSProfile(depth=1, durability=1))
    publisher.publish(String(data="kept"))
    print(wait_for_message(String, node, "one", qos_profile=QoSProfile(depth=1, durability=1)))

    def publish() -> None:
        until(lambda: publisher.get_subscription_count() == 1)
        publisher.publish(String(data="fresh"))

    thread = threading.Thread(target=publish)
    thread.start()
    print(wait_for_message(String, node, "one", time_to_wait=10))
    thread.join()
    print(len(list(node.subscriptions)))


class Anything(Waitable):
    """A user's waitable for four kinds of entities."""

    def __init__(self, node: Node, log: list[object]) -> None:
        super().__init__(ReentrantCallbackGroup())
        profile = QoSProfile(depth=10).get_c_qos_profile()
        with node.handle:
            self.subscription = rcl.Subscription(node.handle, String, "any", profile)
            self.client = rcl.Client(node.handle, SetBool, "any", profile)
            self.service = rcl.Service(node.handle, SetBool, "any", profile)
        self.guard = rcl.GuardCondition(node.context.handle)
        self.log = log
        self.indices: dict[str, int] = {}
        self.ready: set[str] = set()

    def is_ready(self, wait_set: object) -> bool:
        """Remember what is ready."""
        for kind, index in self.indices.items():
            if wait_set.is_ready(kind, index):  # type: ignore[attr-defined]
                self.ready.add(kind)
        return bool(self.ready)

    def take_data(self) -> object:
        """Take one thing."""
        kind = sorted(self.ready)[0]
        self.ready.remove(kind)
        if kind == "subscription":
            return kind, self.subscription.take_message(String, False)[0]
        if kind == "client":
            return kind, self.client.take_response(SetBool.Response)[1]
        if kind == "service":
            request, header = self.service.service_take_request(SetBool.Request)
            self.service.service_send_response(SetBool.Response(success=True), header.request_id)
            return kind, request
        return kind, None

    async def execute(self, taken_data: object) -> None:
        """Note it down."""
        self.log.append(taken_data)

    def get_num_entities(self) -> NumberOfEntities:
        """Return the numbers of entities for the wait set."""
        return NumberOfEntities(num_subs=1, num_gcs=1, num_clients=1, num_services=1)

    def add_to_wait_set(self, wait_set: object) -> None:
        """Add all."""
        self.indices = {
            "subscription": wait_set.add_subscription(self.subscription),  # type: ignore[attr-defined]
            "guard_condition": wait_set.add_guard_condition(self.guard),  # type: ignore[attr-defined]
            "client": wait_set.add_client(self.client),  # type: ignore[attr-defined]
            "service": wait_set.add_service(self.service),  # type: ignore[attr-defined]
        }


def waitables(node: Node, executor: SingleThreadedExecutor) -> None:
    """A user's waitable in an executor, and a bare wait set."""
    log: list[object] = []
    waitable = Anything(node, log)
    node.add_waitable(waitable)
    publisher = node.create_publisher(String, "any", 1)
    until(lambda: publisher.get_subscription_count() == 1 and waitable.client.service_server_is_available())
    spin_for(0.1, executor)
    for act in (
        lambda: publisher.publish(String(data="x")),
        waitable.guard.trigger_guard_condition,
        lambda: waitable.client.send_request(SetBool.Request(data=True)),
    ):
        act()
        spin_for(0.3, executor)
        print(log)
        log.clear()
    node.remove_waitable(waitable)
    wait_set = rcl.WaitSet(1, 1, 0, 0, 0, 0, node.context.handle)
    wait_set.clear_entities()
    attempt("unknown", lambda: wait_set.is_ready("x", 0))
    attempt("unknown", lambda: wait_set.get_ready_entities("x"))
    attempt("events", lambda: wait_set.get_ready_entities("event"))
    attempt("index", lambda: wait_set.is_ready("subscription", 5))
    print(wait_set.add_subscription(waitable.subscription), wait_set.add_guard_condition(waitable.guard))
    attempt("full", lambda: wait_set.add_guard_condition(waitable.guard))
    print(wait_set.is_ready("subscription", 0))
    began = time.monotonic()
    wait_set.wait(100_000_000)
    print(time.monotonic() - began > 0.09)
    print(wait_set.is_ready("subscription", 0), wait_set.get_ready_entities("subscription"))
    wait_set.clear_entities()
    wait_set.add_guard_condition(waitable.guard)
    thread = threading.Thread(target=waitable.guard.trigger_guard_condition)
    thread.start()
    wait_set.wait(-1)
    thread.join()
    print(wait_set.get_ready_entities("guard_condition") == [waitable.guard.pointer])
    attempt("empty", lambda: rcl.WaitSet(0, 0, 0, 0, 0, 0, node.context.handle).wait(0))


def overrides() -> None:
    """Policies changed by parameters."""
    node = rclpy.create_node(
        "o",
        parameter_overrides=[
            Parameter("qos_overrides./a.publisher.depth", value=7),
            Parameter("qos_overrides./a.publisher.reliability", value="best_effort"),
            Parameter("qos_overrides./b.subscription_id.history", value="keep_all"),
            Parameter("qos_overrides./b.subscription_id.lifespan", value=1),
            Parameter("qos_overrides./bad.publisher.reliability", value="nope"),
            Parameter("qos_overrides./typed.publisher.depth", value="x"),
        ],
    )
    every = list(QoSPolicyKind)[1:]

    def make(kind: str, topic: str, options: QoSOverridingOptions) -> object:
        profile = QoSProfile(depth=3)
        if kind == "publisher":
            made = node.create_publisher(String, topic, profile, qos_overriding_options=options)
        else:
            made = node.create_subscription(String, topic, print, profile, qos_overriding_options=options)
        return str(made.qos_profile)

    default = QoSOverridingOptions.with_default_policies()
    attempt("publisher", lambda: make("publisher", "a", default))
    attempt("again", lambda: make("publisher", "a", default))
    attempt("all", lambda: make("publisher", "c", QoSOverridingOptions(every)))
    attempt("subscription", lambda: make("subscription", "b", QoSOverridingOptions(every, entity_id="id")))
    attempt("bad", lambda: make("publisher", "bad", default))
    attempt("typed", lambda: make("publisher", "typed", default))
    refuse = QoSOverridingOptions.with_default_policies(
        callback=lambda profile: SetParametersResult(successful=profile.depth < 3, reason="too deep")
    )
    attempt("refused", lambda: make("publisher", "d", refuse))
    for name in sorted(node.list_parameters(["qos_overrides"], 0).names):
        descriptor = node.describe_parameter(name)
        print(name, node.get_parameter(name).value, descriptor.description, descriptor.read_only)
    node.destroy_node()


def main() -> None:
    """Run every part."""
    rclpy.init()
    node = rclpy.create_node("n")
    type_descriptions(node)
    waiting_for_a_message(node)
    overrides()
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    waitables(node, executor)
    rclpy.shutdown()
