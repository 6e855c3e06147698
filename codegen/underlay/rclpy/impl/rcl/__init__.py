"""What upstream keeps in its C extension module, under that module's names."""

from __future__ import annotations

from typing import Any

from . import service_introspection
from .action_client import ActionClient
from .action_goal import ActionGoalHandle, GoalEvent
from .action_server import ActionServer
from .arguments import rclpy_remove_ros_args
from .client import Client
from .clock import (
    Clock,
    ClockChange,
    ClockEvent,
    ClockType,
    rcl_duration_t,
    rcl_time_point_t,
)
from .context import RCL_DEFAULT_DOMAIN_ID, Context
from .destroyable import Destroyable
from .errors import (
    CONTEXT_NOT_VALID,
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
from .event import EventHandle
from .graph import (
    rclpy_get_client_names_and_types_by_node,
    rclpy_get_publisher_names_and_types_by_node,
    rclpy_get_publishers_info_by_topic,
    rclpy_get_rmw_implementation_identifier,
    rclpy_get_service_names_and_types,
    rclpy_get_service_names_and_types_by_node,
    rclpy_get_subscriber_names_and_types_by_node,
    rclpy_get_subscriptions_info_by_topic,
    rclpy_get_topic_names_and_types,
)
from .guard_condition import GuardCondition
from .lifecycle import LifecycleStateMachine, TransitionCallbackReturnType
from .logging import (
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
from .names import (
    rclpy_expand_topic_name,
    rclpy_get_validation_error_for_full_topic_name,
    rclpy_get_validation_error_for_namespace,
    rclpy_get_validation_error_for_node_name,
    rclpy_get_validation_error_for_topic_name,
    rclpy_remap_topic_name,
    rclpy_resolve_name,
)
from .node import Node
from .publisher import Publisher, rclpy_assert_liveliness
from .qos import (
    RMW_DURATION_INFINITE,
    RMW_QOS_DEADLINE_BEST_AVAILABLE,
    RMW_QOS_LIVELINESS_LEASE_DURATION_BEST_AVAILABLE,
    QoSCheckCompatibleResult,
    QoSCompatibility,
    rclpy_action_get_rmw_qos_profile,
    rclpy_qos_check_compatible,
    rmw_qos_profile_t,
)
from .rosout import rclpy_logging_rosout_add_sublogger, rclpy_logging_rosout_remove_sublogger
from .serialization import rclpy_deserialize, rclpy_serialize
from .service import Service
from .signals import (
    SignalHandlerOptions,
    get_current_signal_handlers_options,
    install_signal_handlers,
    register_sigint_guard_condition,
    uninstall_signal_handlers,
    unregister_sigint_guard_condition,
)
from .structs import (
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
from .subscription import Subscription
from .timer import Timer
from .type_description import TypeDescriptionService
from .wait_set import WaitSet

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
    "rclpy_get_publisher_names_and_types_by_node",
    "rclpy_get_publishers_info_by_topic",
    "rclpy_get_rmw_implementation_identifier",
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


def __getattr__(name: str) -> Any:
    if name == "EventsExecutor":  # stands on the layer above
        from rclpy.impl.events_executor import EventsExecutor

        return EventsExecutor
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
