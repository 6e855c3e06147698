"""Client library for ROS 2: nodes, topics, services, actions, parameters and time, in plain Python.

A program calls `init`, makes nodes (`create_node` or a class derived from `rclpy.node.Node`), spins, and
calls `shutdown`.
"""

from __future__ import annotations

from types import TracebackType
from typing import TYPE_CHECKING

from rclpy.context import Context
from rclpy.impl import distro, program
from rclpy.impl.reexports import reexport
from rclpy.parameter import Parameter
from rclpy.signals import SignalHandlerOptions, install_signal_handlers, uninstall_signal_handlers
from rclpy.task import Future
from rclpy.utilities import get_default_context, get_rmw_implementation_identifier, ok
from rclpy.utilities import shutdown as _shutdown
from rclpy.utilities import try_shutdown as _try_shutdown

if TYPE_CHECKING:
    # What a node brings along: programs write `rclpy.time.Time()` after `import rclpy` alone.
    from rclpy import callback_groups as callback_groups
    from rclpy import client as client
    from rclpy import clock as clock
    from rclpy import clock_type as clock_type
    from rclpy import constants as constants
    from rclpy import context as context
    from rclpy import destroyable as destroyable
    from rclpy import duration as duration
    from rclpy import event_handler as event_handler
    from rclpy import exceptions as exceptions
    from rclpy import executors as executors
    from rclpy import expand_topic_name as expand_topic_name
    from rclpy import guard_condition as guard_condition
    from rclpy import impl as impl
    from rclpy import logging as logging
    from rclpy import logging_service as logging_service
    from rclpy import node as node
    from rclpy import parameter as parameter
    from rclpy import parameter_service as parameter_service
    from rclpy import publisher as publisher
    from rclpy import qos as qos
    from rclpy import qos_overriding_options as qos_overriding_options
    from rclpy import service as service
    from rclpy import service_introspection as service_introspection
    from rclpy import signals as signals
    from rclpy import subscription as subscription
    from rclpy import task as task
    from rclpy import time as time
    from rclpy import time_source as time_source
    from rclpy import timer as timer
    from rclpy import topic_endpoint_info as topic_endpoint_info
    from rclpy import type_description_service as type_description_service
    from rclpy import type_hash as type_hash
    from rclpy import type_support as type_support
    from rclpy import utilities as utilities
    from rclpy import validate_full_topic_name as validate_full_topic_name
    from rclpy import validate_namespace as validate_namespace
    from rclpy import validate_node_name as validate_node_name
    from rclpy import validate_parameter_name as validate_parameter_name
    from rclpy import validate_topic_name as validate_topic_name
    from rclpy import waitable as waitable
    from rclpy.executors import Executor
    from rclpy.node import Node
    from rclpy.qos import QoSProfile
else:
    __getattr__ = reexport(__name__)

__all__ = [
    "Context",
    "Future",
    "Parameter",
    "SignalHandlerOptions",
    "create_node",
    "get_default_context",
    "get_global_executor",
    "get_rmw_implementation_identifier",
    "init",
    "install_signal_handlers",
    "ok",
    "shutdown",
    "spin",
    "spin_once",
    "spin_until_future_complete",
    "try_shutdown",
    "uninstall_signal_handlers",
]


class InitContextManager:
    """The result of `init`: a block, which newer ROS has, shuts the context down at its end.

    :param context: the context that was initialised.
    :param installed_signal_handlers: the signals that `init` handles; the end of the block gives them back.
    """

    def __init__(self, context: Context, installed_signal_handlers: SignalHandlerOptions) -> None:
        self.context = context
        self.installed_signal_handlers = installed_signal_handlers

    def __enter__(self) -> InitContextManager:
        distro.uses("init")
        return self

    def __exit__(
        self,
        exc_type: type[BaseException] | None,
        exc_val: BaseException | None,
        exc_tb: TracebackType | None,
    ) -> None:
        self.context._destroy_nodes()
        _try_shutdown(context=None if self.context is get_default_context() else self.context)
        if self.installed_signal_handlers != SignalHandlerOptions.NO:
            uninstall_signal_handlers()


def init(
    *,
    args: list[str] | None = None,
    context: Context | None = None,
    domain_id: int | None = None,
    signal_handler_options: SignalHandlerOptions | None = None,
) -> InitContextManager:
    """Initialise a context. The result is for a `with` block, or for nothing.

    :param args: the command line; None for the program's own.
    :param context: None for the default one.
    :param domain_id: None for ROS_DOMAIN_ID, else 0.
    :param signal_handler_options: None: SIGINT and SIGTERM for the default context, none for another.
    """
    default = get_default_context()
    context = default if context is None else context
    if signal_handler_options is None:
        signal_handler_options = SignalHandlerOptions.ALL if context is default else SignalHandlerOptions.NO
    context.init(args, domain_id=domain_id)
    install_signal_handlers(signal_handler_options)
    return InitContextManager(context, signal_handler_options)


def get_global_executor() -> Executor:
    """Return the executor that is meant where none is given; it lives as long as the default context."""
    here = program.current()
    known: Executor | None = here.global_executor
    if known is not None and known.context.ok():
        return known
    # Imported here: a program without nodes needs no executor.
    from rclpy.executors import SingleThreadedExecutor

    executor = here.global_executor = SingleThreadedExecutor()

    def forget() -> None:
        executor.shutdown()
        if here.global_executor is executor:
            here.global_executor = None

    executor.context.on_shutdown(forget)
    return executor


def shutdown(*, context: Context | None = None, uninstall_handlers: bool | None = None) -> None:
    """Shut down a context and, with the default one, the global executor.

    :param context: None for the default one.
    :param uninstall_handlers: give signals back; None: if it is the default context.
    :raises RuntimeError: if it is not initialised or was shut down before.
    """
    is_default = context is None or context is get_default_context()
    _shutdown(context=context)
    if uninstall_handlers or (uninstall_handlers is None and is_default):
        uninstall_signal_handlers()


def try_shutdown(*, context: Context | None = None, uninstall_handlers: bool | None = None) -> None:
    """Shut down a context if it is up.

    :param context: None for the default one.
    :param uninstall_handlers: give signals back; None: if it is the default context, but not in Jazzy.
    """
    if uninstall_handlers is not None:
        distro.uses("try_shutdown")
    is_default = context is None or context is get_default_context()
    _try_shutdown(context=context)
    if uninstall_handlers or (uninstall_handlers is None and is_default and distro.follows("node_shutdown")):
        uninstall_signal_handlers()


def create_node(
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
) -> Node:
    """Make a node; all parameters are those of `rclpy.node.Node`."""
    from rclpy.node import Node  # here: the module brings message classes along

    return Node(
        node_name,
        context=context,
        cli_args=cli_args,
        namespace=namespace,
        use_global_arguments=use_global_arguments,
        enable_rosout=enable_rosout,
        rosout_qos_profile=rosout_qos_profile,
        start_parameter_services=start_parameter_services,
        parameter_overrides=parameter_overrides,
        allow_undeclared_parameters=allow_undeclared_parameters,
        automatically_declare_parameters_from_overrides=automatically_declare_parameters_from_overrides,
        enable_logger_service=enable_logger_service,
    )


def spin_once(node: Node, *, executor: Executor | None = None, timeout_sec: float | None = None) -> None:
    """Wait for one callback and run it. It may be one of another node, if a coroutine of that is under way.

    :param node: lent to the executor for this call, unless it is there already.
    :param executor: None for the global one.
    :param timeout_sec: None or negative: no limit; 0: do not wait.
    """
    executor = get_global_executor() if executor is None else executor
    was_added = False
    try:
        was_added = executor.add_node(node)
        executor.spin_once(timeout_sec=timeout_sec)
    finally:
        if was_added:
            executor.remove_node(node)


def spin(node: Node, executor: Executor | None = None) -> None:
    """Run callbacks until the context is shut down.

    :param node: added to the executor, and removed at the end.
    :param executor: None for the global one.
    """
    executor = get_global_executor() if executor is None else executor
    try:
        executor.add_node(node)
        while executor.context.ok():
            executor.spin_once()
    finally:
        executor.remove_node(node)
        executor.context._call_back()


def spin_until_future_complete(
    node: Node, future: Future, executor: Executor | None = None, timeout_sec: float | None = None
) -> None:
    """Run callbacks until a future is done or given up; the caller looks at the future.

    :param node: lent to the executor for this call, unless it is there already.
    :param future: what is waited for.
    :param executor: None for the global one.
    :param timeout_sec: None or negative: no limit.
    """
    executor = get_global_executor() if executor is None else executor
    was_added = False
    try:
        was_added = executor.add_node(node)
        executor.spin_until_future_complete(future, timeout_sec)
    finally:
        if was_added:
            executor.remove_node(node)
