"""Everything that upstream keeps in its C extension module, under the names that it has there."""

from __future__ import annotations

from typing import Any

from rclpy.impl.rcl import service_introspection
from rclpy.impl.rcl.action_client import ActionClient
from rclpy.impl.rcl.action_entity import ActionGoalHandle, GoalEvent
from rclpy.impl.rcl.action_server import ActionServer
from rclpy.impl.rcl.arguments import rclpy_remove_ros_args
from rclpy.impl.rcl.clock import (
    Clock,
    ClockChange,
    ClockEvent,
    ClockType,
    Timer,
    rcl_duration_t,
    rcl_time_point_t,
)
from rclpy.impl.rcl.context import (
    RCL_DEFAULT_DOMAIN_ID,
    Context,
    GuardCondition,
    SignalHandlerOptions,
    get_current_signal_handlers_options,
    install_signal_handlers,
    register_sigint_guard_condition,
    uninstall_signal_handlers,
    unregister_sigint_guard_condition,
)
from rclpy.impl.rcl.graph import (
    rclpy_get_client_names_and_types_by_node,
    rclpy_get_clients_info_by_service,
    rclpy_get_publisher_names_and_types_by_node,
    rclpy_get_publishers_info_by_topic,
    rclpy_get_rmw_implementation_identifier,
    rclpy_get_servers_info_by_service,
    rclpy_get_service_names_and_types,
    rclpy_get_service_names_and_types_by_node,
    rclpy_get_subscriber_names_and_types_by_node,
    rclpy_get_subscriptions_info_by_topic,
    rclpy_get_topic_names_and_types,
)
from rclpy.impl.rcl.handle import (
    CONTEXT_NOT_VALID,
    Destroyable,
    InvalidHandle,
    NodeNameNonExistentError,
    NotImplementedError,
    RCLError,
    RCLInvalidROSArgsError,
    RCUtilsError,
    RMWError,
    UnknownROSArgsError,
    UnsupportedEventTypeError,
)
from rclpy.impl.rcl.lifecycle import LifecycleStateMachine, TransitionCallbackReturnType
from rclpy.impl.rcl.logging import (
    RCUTILS_LOG_SEVERITY,
    rclpy_logging_configure,
    rclpy_logging_fini,
    rclpy_logging_get_logger_effective_level,
    rclpy_logging_get_logger_level,
    rclpy_logging_get_logging_directory,
    rclpy_logging_get_separator_string,
    rclpy_logging_initialize,
    rclpy_logging_logger_is_enabled_for,
    rclpy_logging_rcutils_log,
    rclpy_logging_set_logger_level,
    rclpy_logging_severity_level_from_string,
    rclpy_logging_shutdown,
)
from rclpy.impl.rcl.names import (
    rclpy_expand_topic_name,
    rclpy_get_validation_error_for_full_topic_name,
    rclpy_get_validation_error_for_namespace,
    rclpy_get_validation_error_for_node_name,
    rclpy_get_validation_error_for_topic_name,
)
from rclpy.impl.rcl.node import Node, rclpy_remap_topic_name, rclpy_resolve_name
from rclpy.impl.rcl.qos import (
    RMW_DURATION_INFINITE,
    RMW_QOS_DEADLINE_BEST_AVAILABLE,
    RMW_QOS_LIVELINESS_LEASE_DURATION_BEST_AVAILABLE,
    QoSCheckCompatibleResult,
    QoSCompatibility,
    rclpy_action_get_rmw_qos_profile,
    rclpy_qos_check_compatible,
    rmw_qos_profile_t,
)
from rclpy.impl.rcl.rosout import rclpy_logging_rosout_add_sublogger, rclpy_logging_rosout_remove_sublogger
from rclpy.impl.rcl.services import Client, Service, TypeDescriptionService
from rclpy.impl.rcl.structs import (
    rcl_publisher_event_type_t,
    rcl_subscription_event_type_t,
    rmw_incompatible_type_status_t,
    rmw_liveliness_changed_status_t,
    rmw_liveliness_lost_status_t,
    rmw_matched_status_t,
    rmw_message_lost_status_t,
    rmw_offered_deadline_missed_status_t,
    rmw_qos_policy_kind_t,
    rmw_request_id_t,
    rmw_requested_deadline_missed_status_t,
    rmw_requested_qos_incompatible_event_status_t,
    rmw_service_info_t,
)
from rclpy.impl.rcl.topics import (
    EventHandle,
    Publisher,
    Subscription,
    rclpy_assert_liveliness,
    rclpy_deserialize,
    rclpy_serialize,
)
from rclpy.impl.rcl.wait_set import WaitSet

__all__ = [
    "CONTEXT_NOT_VALID",
    "RCL_DEFAULT_DOMAIN_ID",
    "RCUTILS_LOG_SEVERITY",
    "RMW_DURATION_INFINITE",
    "RMW_QOS_DEADLINE_BEST_AVAILABLE",
    "RMW_QOS_LIVELINESS_LEASE_DURATION_BEST_AVAILABLE",
    "ActionClient",
    "ActionGoalHandle",
    "ActionServer",
    "Client",
    "Clock",
    "ClockChange",
    "ClockEvent",
    "ClockType",
    "Context",
    "Destroyable",
    "EventHandle",
    "GoalEvent",
    "GuardCondition",
    "InvalidHandle",
    "LifecycleStateMachine",
    "Node",
    "NodeNameNonExistentError",
    "NotImplementedError",
    "Publisher",
    "QoSCheckCompatibleResult",
    "QoSCompatibility",
    "RCLError",
    "RCLInvalidROSArgsError",
    "RCUtilsError",
    "RMWError",
    "Service",
    "SignalHandlerOptions",
    "Subscription",
    "Timer",
    "TransitionCallbackReturnType",
    "TypeDescriptionService",
    "UnknownROSArgsError",
    "UnsupportedEventTypeError",
    "WaitSet",
    "get_current_signal_handlers_options",
    "install_signal_handlers",
    "rcl_duration_t",
    "rcl_publisher_event_type_t",
    "rcl_subscription_event_type_t",
    "rcl_time_point_t",
    "rclpy_action_get_rmw_qos_profile",
    "rclpy_assert_liveliness",
    "rclpy_deserialize",
    "rclpy_expand_topic_name",
    "rclpy_get_client_names_and_types_by_node",
    "rclpy_get_clients_info_by_service",
    "rclpy_get_publisher_names_and_types_by_node",
    "rclpy_get_publishers_info_by_topic",
    "rclpy_get_rmw_implementation_identifier",
    "rclpy_get_servers_info_by_service",
    "rclpy_get_service_names_and_types",
    "rclpy_get_service_names_and_types_by_node",
    "rclpy_get_subscriber_names_and_types_by_node",
    "rclpy_get_subscriptions_info_by_topic",
    "rclpy_get_topic_names_and_types",
    "rclpy_get_validation_error_for_full_topic_name",
    "rclpy_get_validation_error_for_namespace",
    "rclpy_get_validation_error_for_node_name",
    "rclpy_get_validation_error_for_topic_name",
    "rclpy_logging_configure",
    "rclpy_logging_fini",
    "rclpy_logging_get_logger_effective_level",
    "rclpy_logging_get_logger_level",
    "rclpy_logging_get_logging_directory",
    "rclpy_logging_get_separator_string",
    "rclpy_logging_initialize",
    "rclpy_logging_logger_is_enabled_for",
    "rclpy_logging_rcutils_log",
    "rclpy_logging_rosout_add_sublogger",
    "rclpy_logging_rosout_remove_sublogger",
    "rclpy_logging_set_logger_level",
    "rclpy_logging_severity_level_from_string",
    "rclpy_logging_shutdown",
    "rclpy_qos_check_compatible",
    "rclpy_remap_topic_name",
    "rclpy_remove_ros_args",
    "rclpy_resolve_name",
    "rclpy_serialize",
    "register_sigint_guard_condition",
    "rmw_incompatible_type_status_t",
    "rmw_liveliness_changed_status_t",
    "rmw_liveliness_lost_status_t",
    "rmw_matched_status_t",
    "rmw_message_lost_status_t",
    "rmw_offered_deadline_missed_status_t",
    "rmw_qos_policy_kind_t",
    "rmw_qos_profile_t",
    "rmw_request_id_t",
    "rmw_requested_deadline_missed_status_t",
    "rmw_requested_qos_incompatible_event_status_t",
    "rmw_service_info_t",
    "service_introspection",
    "uninstall_signal_handlers",
    "unregister_sigint_guard_condition",
]

# What tracebacks, reprs and pickles of the real one say.
for _value in list(globals().values()):
    if isinstance(_value, type) and _value.__module__.startswith("rclpy.impl.rcl."):
        _value.__module__ = __name__


def __getattr__(name: str) -> Any:
    if name == "EventsExecutor":
        from rclpy._executor.events_executor import EventsExecutor  # stands on the layer above

        return EventsExecutor
    if name == "TimerCancelledError":
        from rclpy.impl.rcl.handle import TimerCancelledError  # late: Jazzy's module does not list it

        return TimerCancelledError
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
