"""Replacements in tests for rclpy's own: names in `rclpy.node`, methods that derived classes override."""

from unittest import mock

import rclpy
import rclpy.node
from rclpy.executors import MultiThreadedExecutor, SingleThreadedExecutor
from std_msgs.msg import String
from test_msgs.srv import Empty
from transcript import attempt, until

NAMES = (
    "Client",
    "GuardCondition",
    "LoggingService",
    "MutuallyExclusiveCallbackGroup",
    "ParameterService",
    "PublisherEventCallbacks",
    "Rate",
    "ReentrantCallbackGroup",
    "Service",
    "SubscriptionEventCallbacks",
    "TimeSource",
    "Timer",
    "TopicEndpointInfo",
    "TypeDescriptionService",
    "check_is_valid_msg_type",
    "check_is_valid_srv_type",
    "expand_topic_name",
    "get_default_context",
    "get_logger",
    "validate_full_topic_name",
    "validate_namespace",
    "validate_node_name",
    "validate_parameter_name",
    "validate_topic_name",
)


def use_everything() -> None:
    """Make a node and one of each kind of entity, query the graph, and make mistakes."""
    node = rclpy.node.Node("replaced", enable_logger_service=True)
    node.create_publisher(String, "replaced", 1)
    node.create_subscription(String, "replaced", print, 1)
    node.create_client(Empty, "replaced")
    node.create_service(Empty, "replaced", print)
    node.create_guard_condition(print)
    node.create_rate(1.0)
    node.declare_parameter("a", 1)
    until(lambda: node.get_publishers_info_by_topic("replaced"))
    node.count_publishers("replaced")
    for wrong in (
        lambda: node.create_publisher(String, "wrong name", 1),
        lambda: rclpy.node.Node("wrong name"),
        lambda: rclpy.node.Node("right", namespace="wrong name"),
        lambda: node.count_publishers("wrong name"),
        lambda: node.declare_parameter("", 1),
    ):
        attempt("wrong", wrong)
    node.destroy_node()


def names() -> None:
    """Each name is looked up in `rclpy.node` when it is needed."""
    originals = {name: getattr(rclpy.node, name) for name in NAMES}
    with mock.patch.multiple(
        rclpy.node, **{name: mock.Mock(wraps=original) for name, original in originals.items()}
    ):
        use_everything()
        for name in NAMES:
            print(name, "called" if getattr(rclpy.node, name).called else "not called")


class Tidy(rclpy.node.Node):
    """A node that prints what it is asked to destroy."""

    def destroy_publisher(self, publisher: rclpy.node.Publisher) -> bool:
        """Destroy it, and print the result."""
        return self._say("publisher", super().destroy_publisher(publisher))

    def destroy_subscription(self, subscription: rclpy.node.Subscription) -> bool:
        """Destroy it, and print the result."""
        return self._say("subscription", super().destroy_subscription(subscription))

    def destroy_client(self, client: rclpy.node.Client) -> bool:
        """Destroy it, and print the result."""
        return self._say("client", super().destroy_client(client))

    def destroy_service(self, service: rclpy.node.Service) -> bool:
        """Destroy it, and print the result."""
        return self._say("service", super().destroy_service(service))

    def destroy_timer(self, timer: rclpy.node.Timer) -> bool:
        """Destroy it, and print the result."""
        return self._say("timer", super().destroy_timer(timer))

    def destroy_guard_condition(self, guard: rclpy.node.GuardCondition) -> bool:
        """Destroy it, and print the result."""
        return self._say("guard condition", super().destroy_guard_condition(guard))

    def _say(self, kind: str, destroyed: bool) -> bool:
        print("destroyed", kind, destroyed)
        return destroyed


def destroying() -> None:
    """`destroy_node` calls the methods that destroy one entity."""
    node = Tidy("tidy")
    node.create_publisher(String, "tidy", 1)
    node.create_subscription(String, "tidy", print, 1)
    node.create_client(Empty, "tidy")
    node.create_service(Empty, "tidy", print)
    node.create_timer(1.0, print)
    node.create_guard_condition(print)
    node.destroy_rate(node.create_rate(1.0))
    node.destroy_node()
    node.destroy_node()


def waiting() -> None:
    """Executors find their work through a method that derived classes override."""
    node = rclpy.create_node("waiting")
    for base in (SingleThreadedExecutor, MultiThreadedExecutor):
        asked = []

        class Own(base):  # type: ignore[misc, valid-type]  # each base in turn
            def wait_for_ready_callbacks(self, *args: object, **kwargs: object) -> object:
                asked.append(len(args) + len(kwargs))
                return super().wait_for_ready_callbacks(*args, **kwargs)

        executor, rung = Own(), []
        timer = node.create_timer(0.01, lambda rung=rung: rung.append(1))
        executor.add_node(node)
        executor.spin_once(timeout_sec=5.0)
        print(base.__name__, "asked" if asked else "not asked", until(lambda rung=rung: rung, executor))
        executor.shutdown()

        executor = base()
        executor.add_node(node)
        instead = []
        task = executor.create_task(lambda instead=instead: instead.append("run"))
        with mock.patch.object(
            executor, "wait_for_ready_callbacks", return_value=(task, None, None)
        ) as found:
            executor.spin_once(timeout_sec=5.0)
            print(found.call_args.args[0], until(lambda instead=instead: instead))
        node.destroy_timer(timer)
        executor.shutdown()
    node.destroy_node()


def without_init() -> None:
    """A node whose `__init__` a test has skipped."""
    with mock.patch("rclpy.node.Node.__init__", return_value=None) as made:
        node = rclpy.node.Node("nothing")
    print(made.call_args.args)
    for method in ("get_logger", "get_clock", "get_name", "destroy_node"):
        try:
            getattr(node, method)()
        except AttributeError as error:
            print(method, type(error).__name__)
    node._logger = node._clock = "mine"
    print(node.get_logger(), node.get_clock())
    with mock.patch("rclpy.node.Node.create_publisher") as create:
        node.create_publisher(String, "x", 1)
        print(create.call_args)


def module_functions() -> None:
    """Functions of rclpy call each other through the names of the module."""
    node = rclpy.create_node("functions")
    for name in ("get_global_executor", "ok", "get_default_context", "create_node", "spin_once"):
        with mock.patch.object(rclpy, name, wraps=getattr(rclpy, name)) as replaced:
            rclpy.spin_once(node, timeout_sec=0)
            rclpy.spin_until_future_complete(node, rclpy.Future(), timeout_sec=0.01)
            print(name, replaced.called)
    with mock.patch("rclpy.executors.SingleThreadedExecutor") as executor:
        rclpy.shutdown()
        rclpy.init()
        print(rclpy.get_global_executor() is executor.return_value)
    node.destroy_node()


def main() -> None:
    """All of them."""
    rclpy.init()
    names()
    destroying()
    waiting()
    without_init()
    module_functions()
    rclpy.try_shutdown()
