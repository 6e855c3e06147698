"""`AsyncNode`: a node whose callbacks are coroutines of the user's event loop."""

from __future__ import annotations

import functools
from collections.abc import Callable
from types import TracebackType
from typing import Any, Concatenate, ParamSpec, TypeVar

from rclpy.action import CancelResponse, GoalResponse
from rclpy.action.server import default_cancel_callback, default_goal_callback
from rclpy.context import Context
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.qos import QoSProfile, qos_profile_action_status_default, qos_profile_services_default
from rclpy.timer import Timer

from rclpy_asyncio.action_client import AsyncActionClient
from rclpy_asyncio.action_server import ActionCallbacks, AsyncActionServer
from rclpy_asyncio.clock import AsyncClock, AsyncTimer, run_timer
from rclpy_asyncio.driver import Driver
from rclpy_asyncio.entities import AsyncClient, AsyncPublisher, AsyncService, AsyncSubscription
from rclpy_asyncio.readiness import Bell, ring_later

P = ParamSpec("P")
R = TypeVar("R")


def _of_node(method: Callable[Concatenate[Node, P], R]) -> Callable[Concatenate[AsyncNode, P], R]:
    """Return a method that calls this one on the node of rclpy underneath."""

    def call(self: AsyncNode, /, *args: P.args, **kwargs: P.kwargs) -> R:
        return method(self._node, *args, **kwargs)  # pyright: ignore[reportPrivateUsage]  # its own

    functools.update_wrapper(call, method)
    return call


class AsyncNode:
    """A node that runs on the event loop of its user: `async with node:` or `await node.run()`.

    It may be made, and given entities, before a loop runs. An exception out of a callback ends the node:
    all its tasks are cancelled, and `async with` or `run` raises an ExceptionGroup. Everything but `publish`
    and `destroy_node` belongs to the thread of the loop. No executor can have it.

    Parameters are as those of Node.
    """

    def __init__(
        self,
        node_name: str,
        *,
        context: Context | None = None,
        cli_args: list[str] | None = None,
        namespace: str | None = None,
        use_global_arguments: bool = True,
        enable_rosout: bool = True,
        rosout_qos_profile: QoSProfile | int | None = None,
        start_parameter_services: bool = True,
        parameter_overrides: list[Parameter] | None = None,
        allow_undeclared_parameters: bool = False,
        automatically_declare_parameters_from_overrides: bool = False,
        enable_logger_service: bool = False,
    ) -> None:
        # Jazzy's Node does not know this one.
        options: Any = {} if rosout_qos_profile is None else {"rosout_qos_profile": rosout_qos_profile}
        self._node = Node(
            node_name,
            context=context,
            cli_args=cli_args,
            namespace=namespace,
            use_global_arguments=use_global_arguments,
            enable_rosout=enable_rosout,
            start_parameter_services=start_parameter_services,
            parameter_overrides=parameter_overrides,
            allow_undeclared_parameters=allow_undeclared_parameters,
            automatically_declare_parameters_from_overrides=automatically_declare_parameters_from_overrides,
            enable_logger_service=enable_logger_service,
            **options,
        )
        clock: Any = self._node.get_clock()
        self._clock = AsyncClock(clock)
        self._driver = Driver(self._node, functools.partial(_serve_timer, self._clock))
        self._driver.on_shutdown = self.destroy_node  # type: ignore[method-assign]  # a hook of the driver
        self._entities: dict[Any, None] = {}  # a set with order
        self._is_destroyed = False
        self._is_ended = False
        self._node.context.on_shutdown(self.destroy_node)

    # Its life

    async def __aenter__(self) -> AsyncNode:
        if self._driver.is_running:
            raise RuntimeError("Node is already running")
        if self._is_destroyed:
            raise RuntimeError("Node has been destroyed and cannot be reentered")
        await self._driver.start()
        return self

    async def __aexit__(
        self,
        exc_type: type[BaseException] | None,
        exc_val: BaseException | None,
        exc_tb: TracebackType | None,
    ) -> None:
        self.destroy_node()
        try:
            await self._driver.finish(exc_type, exc_val, exc_tb)
        finally:
            self._end()

    async def run(self) -> None:
        """Run the node until `destroy_node` is called, or the context is shut down.

        :raises RuntimeError: if it runs already, or is destroyed.
        :raises ExceptionGroup: with the exception of a callback.
        """
        async with self:
            await self._driver.ended()

    def destroy_node(self) -> None:
        """Cancel all callbacks, calls and sleeps, and destroy the node; any thread, any number of times.

        Goals of its action servers are ended, and their clients get the results, before the node goes.
        """
        if not self._driver.in_loop():
            ring_later(self._driver.loop, self.destroy_node)
            return
        if self._is_destroyed:
            return
        self._is_destroyed = True
        self._clock.destroy()
        self._driver.stop()
        for entity in list(self._entities):
            entity.destroy()
        if not self._entities:
            self._end()

    def _end(self) -> None:
        """Destroy the node of rclpy, once no action server has a goal any more."""
        if not self._is_ended:
            self._is_ended = True
            self._node.destroy_node()

    # Entities

    def create_publisher(self, msg_type: Any, topic: str, qos_profile: QoSProfile | int) -> AsyncPublisher:
        """Return a publisher, which works at once.

        :raises RuntimeError: if the node is destroyed.
        """
        self._must_live("publisher")
        entity = self._node.create_publisher(msg_type, topic, qos_profile)
        return self._keep(
            AsyncPublisher(self._driver, entity, self._node.destroy_publisher, self._entities.pop)
        )

    def create_subscription(
        self,
        msg_type: Any,
        topic: str,
        callback: Callable[..., Any],
        qos_profile: QoSProfile | int,
        *,
        raw: bool = False,
        concurrent: bool | int = False,
        content_filter_options: Any = None,
    ) -> AsyncSubscription:
        """Subscribe to a topic.

        :param callback: a function or coroutine function of the message, and of its metadata if it takes two.
        :param concurrent: False: the next message is taken when the callback has returned, and the QoS
            history drops what it cannot hold. A number: as many callbacks run at a time. True: 100.
        :raises RuntimeError: if the node is destroyed.
        """
        self._must_live("subscription")
        options: Any = {}
        if content_filter_options is not None:
            options = {"content_filter_options": content_filter_options}
        subscribe: Any = self._node.create_subscription  # whose overloads tell raw messages apart
        entity = subscribe(msg_type, topic, callback, qos_profile, raw=raw, **options)
        wrapper = AsyncSubscription(self._driver, entity, self._node.destroy_subscription, self._entities.pop)
        return self._keep(wrapper.start(concurrent=concurrent))

    def create_service(
        self,
        srv_type: Any,
        srv_name: str,
        callback: Callable[[Any, Any], Any],
        *,
        qos_profile: QoSProfile = qos_profile_services_default,
        concurrent: bool | int = False,
    ) -> AsyncService:
        """Offer a service.

        :param callback: a function or coroutine function of request and response; returns the response.
        :param concurrent: as for `create_subscription`.
        :raises RuntimeError: if the node is destroyed.
        """
        self._must_live("service")
        entity = self._node.create_service(srv_type, srv_name, callback, qos_profile=qos_profile)
        wrapper = AsyncService(self._driver, entity, self._node.destroy_service, self._entities.pop)
        return self._keep(wrapper.start(concurrent=concurrent))

    def create_client(
        self, srv_type: Any, srv_name: str, *, qos_profile: QoSProfile = qos_profile_services_default
    ) -> AsyncClient:
        """Return a client of a service.

        :raises RuntimeError: if the node is destroyed.
        """
        self._must_live("client")
        entity = self._node.create_client(srv_type, srv_name, qos_profile=qos_profile)
        wrapper = AsyncClient(self._driver, entity, self._node.destroy_client, self._entities.pop)
        return self._keep(wrapper.start())

    def create_timer(
        self, timer_period_sec: float, callback: Callable[..., Any], autostart: bool = True
    ) -> AsyncTimer:
        """Call back every period [s] of the node's clock.

        :param callback: a function or coroutine function with no argument, or one for a TimerInfo.
        :param autostart: False: it runs from the first `reset` on.
        :raises RuntimeError: if the node is destroyed, or the callback wants more arguments.
        """
        self._must_live("timer")
        timer = self._node.create_timer(timer_period_sec, _nothing, autostart=autostart)
        try:
            wrapper = AsyncTimer(self._driver, timer, self._clock, callback, self._entities.pop)
        except RuntimeError:
            self._node.destroy_timer(timer)
            raise
        return self._keep(wrapper)

    def create_action_client(
        self,
        action_type: Any,
        action_name: str,
        *,
        goal_service_qos_profile: QoSProfile = qos_profile_services_default,
        result_service_qos_profile: QoSProfile = qos_profile_services_default,
        cancel_service_qos_profile: QoSProfile = qos_profile_services_default,
        feedback_sub_qos_profile: QoSProfile = QoSProfile(depth=10),  # noqa: B008 - immutable in effect; upstream's default
        status_sub_qos_profile: QoSProfile = qos_profile_action_status_default,
    ) -> AsyncActionClient:
        """Return a client of an action.

        :raises RuntimeError: if the node is destroyed.
        """
        self._must_live("action client")
        wrapper = AsyncActionClient(
            self._driver,
            action_type,
            action_name,
            self._entities.pop,
            goal_service_qos_profile=goal_service_qos_profile,
            result_service_qos_profile=result_service_qos_profile,
            cancel_service_qos_profile=cancel_service_qos_profile,
            feedback_sub_qos_profile=feedback_sub_qos_profile,
            status_sub_qos_profile=status_sub_qos_profile,
        )
        return self._keep(wrapper)

    def create_action_server(
        self,
        action_type: Any,
        action_name: str,
        execute_callback: Callable[[Any], Any],
        *,
        goal_callback: Callable[[Any], GoalResponse | Any] = default_goal_callback,
        cancel_callback: Callable[[Any], CancelResponse | Any] = default_cancel_callback,
        concurrent: bool | int = False,
        goal_service_qos_profile: QoSProfile = qos_profile_services_default,
        result_service_qos_profile: QoSProfile = qos_profile_services_default,
        cancel_service_qos_profile: QoSProfile = qos_profile_services_default,
        feedback_pub_qos_profile: QoSProfile = QoSProfile(depth=10),  # noqa: B008 - immutable in effect; upstream's default
        status_pub_qos_profile: QoSProfile = qos_profile_action_status_default,
        result_timeout: int = 10,
    ) -> AsyncActionServer:
        """Offer an action.

        :param execute_callback: a function or coroutine function of the goal handle (ServerGoalHandle); ends
            the goal and returns the result. A cancel request that is accepted cancels the task of a
            coroutine; a function has to ask `is_cancel_requested`.
        :param goal_callback: returns a GoalResponse; accepts all goals by default.
        :param cancel_callback: returns a CancelResponse; refuses by default, as that of ActionServer.
        :param concurrent: False: accepted goals execute one after the other. A number: as many at a time.
            True: 100. Requests are served meanwhile in any case.
        :param result_timeout: how long results are kept [s].
        :raises RuntimeError: if the node is destroyed.
        """
        self._must_live("action server")
        wrapper = AsyncActionServer(
            self._driver,
            action_type,
            action_name,
            ActionCallbacks(execute=execute_callback, goal=goal_callback, cancel=cancel_callback),
            self._entities.pop,
            concurrent=concurrent,
            goal_service_qos_profile=goal_service_qos_profile,
            result_service_qos_profile=result_service_qos_profile,
            cancel_service_qos_profile=cancel_service_qos_profile,
            feedback_pub_qos_profile=feedback_pub_qos_profile,
            status_pub_qos_profile=status_pub_qos_profile,
            result_timeout=result_timeout,
        )
        return self._keep(wrapper)

    def _must_live(self, what: str) -> None:
        if self._is_destroyed:
            raise RuntimeError(f"Cannot create {what} on a destroyed node")

    def _keep(self, entity: R) -> R:
        self._entities[entity] = None
        return entity

    # What it shares with Node

    @property
    def context(self) -> Context:
        """The context the node was made in."""
        return self._node.context

    @property
    def handle(self) -> Any:
        """The client library's side."""
        return self._node.handle

    def get_clock(self) -> AsyncClock:
        """Return the node's clock, which follows ROS time."""
        return self._clock

    async def wait_for_node(self, fully_qualified_node_name: str, *, check_interval: float = 0.1) -> None:
        """Wait until a node is there; `asyncio.timeout` limits it.

        :param check_interval: how often to look [s], where rclpy announces no change of the graph.
        :raises RuntimeError: if this node does not run.
        """
        self._driver.must_run(f"wait for the node {fully_qualified_node_name}")
        name = f"/{fully_qualified_node_name.lstrip('/')}"

        def is_there() -> bool:
            return any(
                f"{namespace.rstrip('/')}/{node}" == name
                for node, namespace in self._node.get_node_names_and_namespaces()
            )

        await self._driver.sources.until(is_there, check_interval)

    get_name = _of_node(Node.get_name)
    get_namespace = _of_node(Node.get_namespace)
    get_fully_qualified_name = _of_node(Node.get_fully_qualified_name)
    get_logger = _of_node(Node.get_logger)

    declare_parameter = _of_node(Node.declare_parameter)
    declare_parameters = _of_node(Node.declare_parameters)
    undeclare_parameter = _of_node(Node.undeclare_parameter)
    has_parameter = _of_node(Node.has_parameter)
    get_parameter_types = _of_node(Node.get_parameter_types)
    get_parameter_type = _of_node(Node.get_parameter_type)
    get_parameters = _of_node(Node.get_parameters)
    get_parameter = _of_node(Node.get_parameter)
    get_parameter_or = _of_node(Node.get_parameter_or)
    get_parameters_by_prefix = _of_node(Node.get_parameters_by_prefix)
    list_parameters = _of_node(Node.list_parameters)
    describe_parameter = _of_node(Node.describe_parameter)
    describe_parameters = _of_node(Node.describe_parameters)
    set_descriptor = _of_node(Node.set_descriptor)
    set_parameters = _of_node(Node.set_parameters)
    set_parameters_atomically = _of_node(Node.set_parameters_atomically)
    add_pre_set_parameters_callback = _of_node(Node.add_pre_set_parameters_callback)
    add_on_set_parameters_callback = _of_node(Node.add_on_set_parameters_callback)
    add_post_set_parameters_callback = _of_node(Node.add_post_set_parameters_callback)
    remove_pre_set_parameters_callback = _of_node(Node.remove_pre_set_parameters_callback)
    remove_on_set_parameters_callback = _of_node(Node.remove_on_set_parameters_callback)
    remove_post_set_parameters_callback = _of_node(Node.remove_post_set_parameters_callback)

    resolve_topic_name = _of_node(Node.resolve_topic_name)
    resolve_service_name = _of_node(Node.resolve_service_name)
    get_node_names = _of_node(Node.get_node_names)
    get_fully_qualified_node_names = _of_node(Node.get_fully_qualified_node_names)
    get_node_names_and_namespaces = _of_node(Node.get_node_names_and_namespaces)
    get_node_names_and_namespaces_with_enclaves = _of_node(Node.get_node_names_and_namespaces_with_enclaves)
    get_topic_names_and_types = _of_node(Node.get_topic_names_and_types)
    get_service_names_and_types = _of_node(Node.get_service_names_and_types)
    get_publisher_names_and_types_by_node = _of_node(Node.get_publisher_names_and_types_by_node)
    get_subscriber_names_and_types_by_node = _of_node(Node.get_subscriber_names_and_types_by_node)
    get_service_names_and_types_by_node = _of_node(Node.get_service_names_and_types_by_node)
    get_client_names_and_types_by_node = _of_node(Node.get_client_names_and_types_by_node)
    get_publishers_info_by_topic = _of_node(Node.get_publishers_info_by_topic)
    get_subscriptions_info_by_topic = _of_node(Node.get_subscriptions_info_by_topic)
    count_publishers = _of_node(Node.count_publishers)
    count_subscribers = _of_node(Node.count_subscribers)
    count_clients = _of_node(Node.count_clients)
    count_services = _of_node(Node.count_services)


def _nothing() -> None:
    """Stand for the callback of a timer that a coroutine serves."""


async def _serve_timer(clock: AsyncClock, driver: Driver, timer: Timer) -> None:
    """Run a timer that has a callback of rclpy."""
    callback: Any = timer.callback
    if timer.clock is not driver.node.get_clock():
        clock = AsyncClock(timer.clock)
    await run_timer(timer, clock, Bell(driver.loop), lambda due: callback())


async def spin(node: Node) -> None:
    """Run an ordinary node on the event loop, until the task is cancelled or the context is shut down.

    Its `async def` callbacks run on the loop, so that everything of asyncio works in them besides futures of
    rclpy. Callback groups count. The node has no executor meanwhile, and may be given to one afterwards.

    :raises ExceptionGroup: with the exception of a callback.
    """
    clock: Any = node.get_clock()
    executor = node.executor
    if executor is not None:
        executor.remove_node(node)
    async_clock = AsyncClock(clock)
    driver = Driver(node, functools.partial(_serve_timer, async_clock), bridges=True)
    node.context.on_shutdown(driver.stop)
    await driver.start()
    error: BaseException | None = None
    try:
        await driver.ended()
    except BaseException as raised:
        error = raised
    driver.stop()
    for task in driver.goals:
        task.cancel()
    async_clock.destroy()
    node.executor = None
    await driver.finish(type(error) if error else None, error, None)
    if error is not None:
        raise error
