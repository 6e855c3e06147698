"""`Node`, the start of everything: it has a name, creates entities, holds parameters and sees the graph."""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeVar

from rcl_interfaces.msg import (
    FloatingPointRange,
    IntegerRange,
    ListParametersResult,
    ParameterDescriptor,
    ParameterEvent,
    ParameterType,
    ParameterValue,
    SetParametersResult,
)

from rclpy._node.entities import EntityFactory
from rclpy._node.graph import GraphQueries
from rclpy._node.parameters import ParameterOwner
from rclpy.callback_groups import CallbackGroup, MutuallyExclusiveCallbackGroup, ReentrantCallbackGroup
from rclpy.client import Client
from rclpy.clock import Clock, ROSClock
from rclpy.constants import S_TO_NS
from rclpy.context import Context
from rclpy.event_handler import PublisherEventCallbacks, SubscriptionEventCallbacks
from rclpy.exceptions import (
    InvalidHandle,
    InvalidParameterTypeException,
    InvalidParameterValueException,
    InvalidTopicNameException,
    NotInitializedException,
    ParameterAlreadyDeclaredException,
    ParameterImmutableException,
    ParameterNotDeclaredException,
    ParameterUninitializedException,
)
from rclpy.executors import Executor
from rclpy.expand_topic_name import expand_topic_name
from rclpy.guard_condition import GuardCondition
from rclpy.impl.adoption import adopt_parts
from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy
from rclpy.impl.lending import lend
from rclpy.logging import get_logger
from rclpy.logging_service import LoggingService
from rclpy.parameter import PARAMETER_SEPARATOR_STRING, Parameter
from rclpy.parameter_service import ParameterService
from rclpy.publisher import Publisher
from rclpy.qos import QoSProfile, qos_profile_parameter_events, qos_profile_services_default
from rclpy.qos_overriding_options import QoSOverridingOptions
from rclpy.service import Service
from rclpy.subscription import Subscription
from rclpy.time_source import TimeSource
from rclpy.timer import Rate, Timer
from rclpy.topic_endpoint_info import TopicEndpointInfo
from rclpy.type_description_service import TypeDescriptionService
from rclpy.type_support import check_is_valid_msg_type, check_is_valid_srv_type
from rclpy.utilities import get_default_context
from rclpy.validate_full_topic_name import validate_full_topic_name
from rclpy.validate_namespace import validate_namespace
from rclpy.validate_node_name import validate_node_name
from rclpy.validate_parameter_name import validate_parameter_name
from rclpy.validate_topic_name import validate_topic_name
from rclpy.waitable import Waitable

if not TYPE_CHECKING:
    __getattr__ = lend(__name__)

# Programs import what nodes deal in from here as well, and the parts in `rclpy._node` look it up here.
__all__ = [
    "HIDDEN_NODE_PREFIX",
    "PARAMETER_SEPARATOR_STRING",
    "S_TO_NS",
    "CallbackGroup",
    "Client",
    "Clock",
    "Context",
    "Executor",
    "FloatingPointRange",
    "GuardCondition",
    "IntegerRange",
    "InvalidHandle",
    "InvalidParameterTypeException",
    "InvalidParameterValueException",
    "InvalidTopicNameException",
    "ListParametersResult",
    "LoggingService",
    "MsgType",
    "MutuallyExclusiveCallbackGroup",
    "Node",
    "NodeNameNonExistentError",
    "NotInitializedException",
    "Parameter",
    "ParameterAlreadyDeclaredException",
    "ParameterDescriptor",
    "ParameterEvent",
    "ParameterImmutableException",
    "ParameterNotDeclaredException",
    "ParameterService",
    "ParameterType",
    "ParameterUninitializedException",
    "ParameterValue",
    "Publisher",
    "PublisherEventCallbacks",
    "QoSOverridingOptions",
    "QoSProfile",
    "ROSClock",
    "Rate",
    "ReentrantCallbackGroup",
    "Service",
    "SetParametersResult",
    "SrvType",
    "SrvTypeRequest",
    "SrvTypeResponse",
    "Subscription",
    "SubscriptionEventCallbacks",
    "TimeSource",
    "Timer",
    "TopicEndpointInfo",
    "TypeDescriptionService",
    "Waitable",
    "check_is_valid_msg_type",
    "check_is_valid_srv_type",
    "expand_topic_name",
    "get_default_context",
    "get_logger",
    "qos_profile_parameter_events",
    "qos_profile_services_default",
    "validate_full_topic_name",
    "validate_namespace",
    "validate_node_name",
    "validate_parameter_name",
    "validate_topic_name",
]

HIDDEN_NODE_PREFIX = "_"

MsgType = TypeVar("MsgType")
SrvType = TypeVar("SrvType")
SrvTypeRequest = TypeVar("SrvTypeRequest")
SrvTypeResponse = TypeVar("SrvTypeResponse")

NodeNameNonExistentError = _rclpy.NodeNameNonExistentError


@adopt_parts
class Node(EntityFactory, ParameterOwner, GraphQueries):
    """A node: the unit of naming, ownership and parameters.

    `cli_args` are arguments for this node alone and win over those of the process, which
    `use_global_arguments=False` ignores. `parameter_overrides` win over values from arguments and files. With
    `enable_logger_service` others can read and set logger levels.
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
        start_parameter_services: bool = True,
        parameter_overrides: list[Parameter] | None = None,
        allow_undeclared_parameters: bool = False,
        automatically_declare_parameters_from_overrides: bool = False,
        enable_logger_service: bool = False,
    ) -> None:
        """Raises NotInitializedException, InvalidNodeNameException, InvalidNamespaceException, RCLError."""
        super().__init__(
            node_name,
            context=context,
            cli_args=cli_args,
            namespace=namespace,
            use_global_arguments=use_global_arguments,
            enable_rosout=enable_rosout,
            allow_undeclared_parameters=allow_undeclared_parameters,
        )
        self._parameter_event_publisher = self.create_publisher(
            ParameterEvent, "/parameter_events", qos_profile_parameter_events
        )
        with self.handle:
            self._parameter_overrides = self.handle.get_parameters(Parameter)
        self._parameter_overrides.update({override.name: override for override in parameter_overrides or ()})
        self._clock = ROSClock()
        if automatically_declare_parameters_from_overrides:
            self.declare_parameters(
                "",
                [
                    (name, override.value, ParameterDescriptor())
                    for name, override in self._parameter_overrides.items()
                ],
                ignore_override=True,
            )
        # From here on parameters are declared: overrides, event publisher and clock have to be there.
        self._time_source = TimeSource(node=self)
        self._time_source.attach_clock(self._clock)
        if start_parameter_services:
            self._parameter_service = ParameterService(self)
        if enable_logger_service:
            self._logger_service = LoggingService(self)
        self._type_description_service = TypeDescriptionService(self)

    def destroy_node(self) -> None:
        """Destroy the node and everything it created; a second call does nothing."""
        self._parameter_event_publisher = None
        self._type_description_service.destroy()
        super().destroy_node()
