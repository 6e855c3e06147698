"""`Node`, the start of everything: it has a name, creates entities, holds parameters and sees the graph."""

from __future__ import annotations

import warnings
import weakref
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import suppress
from typing import TYPE_CHECKING, Any, Literal, TypeVar, overload

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
from rcl_interfaces.msg import Parameter as ParameterMsg

from rclpy._parameters import rules
from rclpy._parameters.declarations import (
    Restoring,
    check_strings,
    keep_or_remove,
    list_names,
    must_fit,
    read_declaration,
)
from rclpy._parameters.rules import ON_TYPE_MISMATCH, follow_policy
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
from rclpy.impl import distro
from rclpy.impl.blocking import Block, wait_for_graph
from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy
from rclpy.impl.messages import cleaned, wrong_return
from rclpy.impl.reexports import reexport
from rclpy.impl.topic_endpoint_info import TopicEndpointInfo
from rclpy.logging import get_logger
from rclpy.logging_service import LoggingService
from rclpy.parameter import PARAMETER_SEPARATOR_STRING, Parameter
from rclpy.parameter_service import ParameterService
from rclpy.publisher import Publisher
from rclpy.qos import QoSProfile, _rosout_profile, qos_profile_parameter_events, qos_profile_services_default
from rclpy.qos_overriding_options import QoSOverridingOptions, _declare_qos_parameters
from rclpy.service import Service
from rclpy.subscription import Subscription
from rclpy.subscription_content_filter_options import ContentFilterOptions
from rclpy.time_source import TimeSource
from rclpy.timer import Rate, Timer
from rclpy.type_description_service import TypeDescriptionService
from rclpy.type_support import _class_of, check_is_valid_msg_type, check_is_valid_srv_type
from rclpy.utilities import get_default_context
from rclpy.validate_full_topic_name import validate_full_topic_name
from rclpy.validate_namespace import validate_namespace
from rclpy.validate_node_name import validate_node_name
from rclpy.validate_parameter_name import validate_parameter_name
from rclpy.validate_topic_name import validate_topic_name
from rclpy.waitable import Waitable

if TYPE_CHECKING:
    from rclpy.impl.newer import ServiceEndpointInfo
    from rclpy.impl.rcutils_logger import RcutilsLogger
    from rclpy.impl.typed import (
        HasViews,
        InfoCallback,
        MaybeAsync,
        MessageCallback,
        MessageT,
        RequestT,
        ResponseT,
        ServiceClass,
        ServiceT_co,
        ViewsT,
    )
else:
    __getattr__ = reexport(__name__)

# Programs import what nodes deal in from here as well.
__all__ = [
    "HIDDEN_NODE_PREFIX",
    "PARAMETER_SEPARATOR_STRING",
    "S_TO_NS",
    "CallbackGroup",
    "Client",
    "Clock",
    "ContentFilterOptions",
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

_PreSetCallback = Callable[[list[Parameter]], list[Parameter]]
_OnSetCallback = Callable[[list[Parameter]], SetParametersResult]
_PostSetCallback = Callable[[list[Parameter]], None]
_Descriptors = dict[str, ParameterDescriptor]
_NamesAndTypes = list[tuple[str, list[str]]]
_Entity = TypeVar("_Entity")


def _open(
    context: Context,
    name: str,
    namespace: str,
    arguments: list[str] | None,
    use_global: bool,
    rosout: bool,
    rosout_qos: QoSProfile | int | None,
) -> _rclpy.Node:
    """Return the handle of a new node."""
    qos = None
    if rosout_qos is not None:
        distro.uses("rosout_qos_profile")
        profile = _rosout_profile(rosout_qos) if isinstance(rosout_qos, int) else rosout_qos
        qos = profile.get_c_qos_profile()
    try:
        with context.handle:
            return _rclpy.Node(name, namespace, context.handle, arguments, use_global, rosout, qos)
    except ValueError:
        # These say which character is wrong.
        validate_node_name(name)
        validate_namespace(namespace if namespace.startswith("/") else f"/{namespace}")
        raise


def _content_filter(options: ContentFilterOptions) -> tuple[str, list[str]]:
    """The parts of the options; AttributeError for a plain tuple, as upstream."""
    return options.filter_expression, options.expression_parameters


class _BaseNode:
    """The common part of nodes of all kinds: name, parameters, logger, clock, graph, services about them.

    It knows no executor. Each kind creates entities in its own way. Its name is `rclpy.node.BaseNode`.

    Each change of a parameter is checked, offered to callbacks and published as an event. Callbacks of one
    kind run newest first. Overrides replace the value that a parameter is declared with.

    Queries of the graph by node raise NodeNameNonExistentError for a node that does not exist.
    """

    PARAM_REL_TOL = rules.RELATIVE_TOLERANCE

    if TYPE_CHECKING:  # each kind of node has its own, with arguments of its own
        create_publisher: Callable[..., Any]
        create_subscription: Callable[..., Any]
        create_service: Callable[..., Any]
        _create_service: Callable[..., Any]
        destroy_subscription: Callable[..., Any]

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
        """Raises NotInitializedException, InvalidNodeNameException, InvalidNamespaceException, RCLError."""
        # Names with one underscore are upstream's: programs look at them, and tests set them. Users derive
        # from nodes and use any name for their attributes, so our own names have two.
        self._context = get_default_context() if context is None else context
        self._parameters: dict[str, Parameter] = {}
        self._descriptors: dict[str, ParameterDescriptor] = {}
        self._allow_undeclared_parameters = allow_undeclared_parameters
        self._pre_set_parameters_callbacks: list[_PreSetCallback] = []
        self._on_set_parameters_callbacks: list[_OnSetCallback] = []
        self._post_set_parameters_callbacks: list[_PostSetCallback] = []
        if not self._context.ok():
            raise NotInitializedException("cannot create node")
        self.__node = _open(
            self._context,
            node_name,
            namespace or "",
            cli_args,
            use_global_arguments,
            enable_rosout,
            rosout_qos_profile,
        )
        self._context._nodes.add(self)
        with self.__node:
            self._logger = get_logger(self.__node.logger_name())
        self._parameter_event_publisher: Publisher[Any] | None = self.create_publisher(
            ParameterEvent, "/parameter_events", qos_profile_parameter_events
        )
        with self.handle:
            self._parameter_overrides = self.handle.get_parameters(Parameter)
        self._parameter_overrides.update({override.name: override for override in parameter_overrides or ()})
        follow_policy(self)
        self.handle.use_parameters(None if allow_undeclared_parameters else [ON_TYPE_MISMATCH])
        self._clock = ROSClock()
        if automatically_declare_parameters_from_overrides:
            given = [
                (name, each.value, ParameterDescriptor()) for name, each in self._parameter_overrides.items()
            ]
            self.declare_parameters("", given, ignore_override=True)
        # From here on parameters are declared: overrides, event publisher and clock have to be there.
        self._time_source = TimeSource(node=self)
        self._time_source.attach_clock(self._clock)
        if start_parameter_services:
            self._parameter_service = ParameterService(self)
        if enable_logger_service:
            self._logger_service = LoggingService(self)
        self._type_description_service = TypeDescriptionService(self)

    @property
    def context(self) -> Context:
        """The context the node was made in."""
        return self._context

    @property
    def handle(self) -> _rclpy.Node:
        """The handle below; it cannot be replaced (AttributeError)."""
        return self.__node

    @handle.setter
    def handle(self, value: Any) -> None:
        raise AttributeError("handle cannot be modified after node creation")

    def get_name(self) -> str:
        """Return the name, remapped."""
        with self.handle:
            return self.handle.get_node_name()

    def get_namespace(self) -> str:
        """Return the namespace, remapped and absolute."""
        with self.handle:
            return self.handle.get_namespace()

    def get_fully_qualified_name(self) -> str:
        """Return namespace and name in one."""
        with self.handle:
            return self.handle.get_fully_qualified_name()

    def get_clock(self) -> Clock:
        """Return the node's clock, which follows ROS time."""
        return self._clock

    def get_logger(self) -> RcutilsLogger:
        """Return the logger with the node's name."""
        return self._logger

    # Parameters: declaring and reading them

    def declare_parameter(
        self,
        name: str,
        value: Any = None,
        descriptor: ParameterDescriptor | None = None,
        ignore_override: bool = False,
    ) -> Parameter:
        """Declare a parameter with a default value, or with a `Parameter.Type` and no value yet.

        Returns it with the value it really got. Raises ParameterAlreadyDeclaredException,
        InvalidParameterException, InvalidParameterTypeException, and InvalidParameterValueException when a
        callback or a range refuses the value.
        """
        entry: Any = (name,)
        if value is not None or descriptor is not None:
            entry = (name, value, ParameterDescriptor() if descriptor is None else descriptor)
        return self.declare_parameters("", [entry], ignore_override)[0]

    def declare_parameters(
        self,
        namespace: str,
        parameters: Sequence[tuple[str] | tuple[str, Any] | tuple[str, Any, ParameterDescriptor]],
        ignore_override: bool = False,
    ) -> list[Parameter]:
        """Declare several parameters `namespace.name`, one event each; see `declare_parameter`.

        Those before a refused one stay declared. Pre-set callbacks are not called.
        """
        overrides = {} if ignore_override else self._parameter_overrides
        declarations = [
            read_declaration(index, entry, namespace, overrides, validate_parameter_name)
            for index, entry in enumerate(parameters)
        ]
        names = [parameter.name for parameter, _ in declarations]
        self.handle.use_parameters(names)
        if known := [name for name in names if name in self._parameters]:
            raise ParameterAlreadyDeclaredException(known)
        for parameter, descriptor in declarations:
            must_fit(parameter.to_parameter_msg())
            must_fit(descriptor)
        self._declare_parameter_common(
            [parameter for parameter, _ in declarations],
            {parameter.name: descriptor for parameter, descriptor in declarations},
        )
        return [self._parameters[name] for name in names]

    def _declare_parameter_common(
        self,
        parameter_list: list[Parameter],
        descriptors: _Descriptors | None = None,
    ) -> list[SetParametersResult]:
        results = []
        for parameter in parameter_list:
            result = self._set_parameters_atomically_common([parameter], descriptors, allow_not_set_type=True)
            if not result.successful:
                if descriptors is not None and result.reason.startswith("Wrong parameter type"):
                    expected: Any = Parameter.Type(descriptors[parameter.name].type).name
                    raise InvalidParameterTypeException(parameter, expected)
                raise InvalidParameterValueException(parameter.name, parameter.value, result.reason)
            results.append(result)
        return results

    def undeclare_parameter(self, name: str) -> None:
        """Forget a parameter.

        Raises ParameterNotDeclaredException, ParameterImmutableException if read-only.
        """
        if not self.has_parameter(name):
            raise ParameterNotDeclaredException(name)
        if self._descriptors[name].read_only:
            raise ParameterImmutableException(name)
        del self._parameters[name]
        del self._descriptors[name]
        if name == ON_TYPE_MISMATCH:
            follow_policy(self)

    def has_parameter(self, name: str) -> bool:
        """Whether the parameter is declared."""
        return name in self._parameters

    def get_parameter_types(self, names: list[str]) -> list[Any]:
        """Return the type of each parameter; see `get_parameter_type`."""
        check_strings(names)
        return [self.get_parameter_type(name) for name in names]

    def get_parameter_type(self, name: str) -> Any:
        """Return the number of a parameter's type; raises ParameterNotDeclaredException."""
        if self.has_parameter(name):
            return self._parameters[name].type_.value
        if self._allow_undeclared_parameters:
            return Parameter.Type.NOT_SET
        raise ParameterNotDeclaredException(name)

    def get_parameters(self, names: list[str]) -> list[Parameter]:
        """Return each parameter; see `get_parameter`."""
        check_strings(names)
        return [self.get_parameter(name) for name in names]

    def get_parameter(self, name: str) -> Parameter:
        """Return a parameter; raises ParameterNotDeclaredException, or ParameterUninitializedException.

        Where undeclared parameters are allowed, they are returned as not set.
        """
        parameter = self._parameters.get(name)
        if parameter is None:
            if self._allow_undeclared_parameters:
                return Parameter(name, Parameter.Type.NOT_SET, None)
            raise ParameterNotDeclaredException(name)
        if parameter.type_ is Parameter.Type.NOT_SET and not self._descriptors[name].dynamic_typing:
            raise ParameterUninitializedException(name)
        return parameter

    def get_parameter_or(self, name: str, alternative_value: Parameter | None = None) -> Parameter:
        """Return a parameter, or the alternative (by default one that is not set) if it has no value."""
        parameter = self._parameters.get(name)
        if parameter is not None and parameter.type_ is not Parameter.Type.NOT_SET:
            return parameter
        return Parameter(name, Parameter.Type.NOT_SET) if alternative_value is None else alternative_value

    def get_parameters_by_prefix(self, prefix: str) -> dict[str, Parameter]:
        """Return the parameters below `prefix.` by the rest of their names.

        All of them for the empty prefix.
        """
        if prefix:
            prefix += PARAMETER_SEPARATOR_STRING
        return {
            name[len(prefix) :]: parameter
            for name, parameter in list(self._parameters.items())
            if name.startswith(prefix)
        }

    def list_parameters(self, prefixes: list[str], depth: int) -> ListParametersResult:
        """Return the names below the prefixes, at most `depth` levels deep (0: all), and their prefixes."""
        return list_names(list(self._parameters), prefixes, depth)

    def describe_parameter(self, name: str) -> ParameterDescriptor:
        """Return the descriptor of a parameter; raises ParameterNotDeclaredException."""
        descriptor = self._descriptors.get(name)
        if descriptor is not None:
            return descriptor
        if self._allow_undeclared_parameters:
            return ParameterDescriptor()
        raise ParameterNotDeclaredException(name)

    def describe_parameters(self, names: list[str]) -> list[ParameterDescriptor]:
        """Return the descriptor of each parameter; raises ParameterNotDeclaredException."""
        return [self.describe_parameter(name) for name in names]

    def set_descriptor(
        self,
        name: str,
        descriptor: ParameterDescriptor,
        alternative_value: ParameterValue | None = None,
    ) -> ParameterValue:
        """Give a parameter another descriptor; if it forbids the value, the alternative is set.

        Returns the value. Raises ParameterNotDeclaredException, ParameterImmutableException, and
        InvalidParameterValueException when the alternative is forbidden, too.
        """
        if not self.has_parameter(name):
            return self.get_parameter(name).get_parameter_value()
        if self.describe_parameter(name).read_only:
            raise ParameterImmutableException(name)
        current = alternative = self.get_parameter(name)
        if alternative_value is not None:
            alternative = Parameter.from_parameter_msg(ParameterMsg(name=name, value=alternative_value))
        for parameter in (current, alternative):
            result = self.__check([parameter], {name: descriptor}, check_read_only=False)
            if result.successful:
                break
        else:
            raise InvalidParameterValueException(name, alternative.value, result.reason)
        self._parameters[name] = parameter
        self._descriptors[name] = descriptor
        return self.get_parameter(name).get_parameter_value()

    # Parameters: setting them

    def set_parameters(self, parameter_list: list[Parameter]) -> list[SetParametersResult]:
        """Set one parameter after the other and return a result for each.

        Raises ParameterNotDeclaredException; those before are set then.
        """
        for parameter in parameter_list:
            if isinstance(parameter, Parameter):  # else refused below
                must_fit(parameter.to_parameter_msg())
        return [self._set_parameters_atomically([parameter]) for parameter in parameter_list]

    def set_parameters_atomically(self, parameter_list: list[Parameter]) -> SetParametersResult:
        """Set all parameters or none; raises ParameterNotDeclaredException."""
        return self._set_parameters_atomically(parameter_list)

    def _set_parameters_atomically(self, parameter_list: list[Parameter]) -> SetParametersResult:
        if self._pre_set_parameters_callbacks:
            changed: list[Parameter] = []
            for callback in self._pre_set_parameters_callbacks:
                answer: object = callback(parameter_list)
                if not isinstance(answer, Iterable):
                    raise TypeError(wrong_return("a pre-set callback of parameters", answer, list))
                changed += answer
            parameter_list = changed
            if not parameter_list:
                return rules.refused(
                    "parameter list cannot be empty, this might be due to pre_set_parameters_callback "
                    "modifying the original parameters list."
                )
        self._check_undeclared_parameters(parameter_list)
        return self._set_parameters_atomically_common(parameter_list)

    def _check_undeclared_parameters(self, parameter_list: list[Parameter]) -> None:
        if not all(isinstance(parameter, Parameter) for parameter in parameter_list):
            raise TypeError(f"parameter must be instance of type '{Parameter!r}'")
        undeclared = [
            parameter.name for parameter in parameter_list if parameter.name not in self._parameters
        ]
        if undeclared and not self._allow_undeclared_parameters:
            raise ParameterNotDeclaredException(undeclared)
        for parameter in parameter_list:
            must_fit(parameter.to_parameter_msg())

    def _set_parameters_atomically_common(
        self,
        parameter_list: list[Parameter],
        descriptors: _Descriptors | None = None,
        allow_not_set_type: bool = False,
    ) -> SetParametersResult:
        """Check, ask, set, publish, notify. `descriptors` come with a declaration.

        Nothing is changed where this is refused, or fails before the change is published.
        """
        with Restoring(parameter_list, self._parameters, self._descriptors) as restoring:
            result = self.__set_and_publish(parameter_list, descriptors, allow_not_set_type)
            restoring.is_needed = not result.successful
        if result.successful:
            for post_set in list(self._post_set_parameters_callbacks):
                post_set(parameter_list)
        return result

    def __set_and_publish(
        self, parameter_list: list[Parameter], descriptors: _Descriptors | None, allow_not_set_type: bool
    ) -> SetParametersResult:
        result = self.__check(
            parameter_list,
            self._descriptors if descriptors is None else descriptors,
            check_read_only=descriptors is None,
        )
        if not result.successful:
            return result
        for on_set in list(self._on_set_parameters_callbacks):
            result = on_set(parameter_list)
            if not isinstance(result, SetParametersResult):
                warnings.warn(
                    "Callback returned an invalid type, it should return SetParameterResult.", stacklevel=4
                )
                result = rules.refused("Callback returned an invalid type")
            if not result.successful:
                return result
        event = ParameterEvent(node=self.get_fully_qualified_name())
        for parameter in parameter_list:
            is_kept = allow_not_set_type or parameter.type_ is not Parameter.Type.NOT_SET
            keep_or_remove(parameter, self._parameters, self._descriptors, descriptors, event, keep=is_kept)
        if any(parameter.name == ON_TYPE_MISMATCH for parameter in parameter_list):
            follow_policy(self)
        event.stamp = self._clock.now().to_msg()
        if self._parameter_event_publisher is not None:
            self._parameter_event_publisher.publish(cleaned(event))
        return rules.accepted()

    def __check(
        self, parameter_list: list[Parameter], descriptors: _Descriptors, *, check_read_only: bool
    ) -> SetParametersResult:
        """Hold values against their descriptors; return what the first wrong one is refused with."""
        return rules.check(
            parameter_list,
            descriptors,
            self._parameters,
            check_read_only=check_read_only,
            tolerance=self.PARAM_REL_TOL,
        )

    def add_pre_set_parameters_callback(self, callback: _PreSetCallback) -> None:
        """Let `callback` change the list of parameters before it is checked; it returns the new list."""
        self._pre_set_parameters_callbacks.insert(0, callback)

    def add_on_set_parameters_callback(self, callback: _OnSetCallback) -> None:
        """Let `callback` refuse parameters: it returns a SetParametersResult.

        Raises TypeError unless callable.
        """
        if not callable(callback):
            raise TypeError("Callback must be callable, got {}", type(callback))
        self._on_set_parameters_callbacks.insert(0, callback)

    def add_post_set_parameters_callback(self, callback: _PostSetCallback) -> None:
        """Tell `callback` about parameters that were set. Raises TypeError unless callable."""
        if not callable(callback):
            raise TypeError("Callback must be callable, got {}", type(callback))
        self._post_set_parameters_callbacks.insert(0, callback)

    def remove_pre_set_parameters_callback(self, callback: _PreSetCallback) -> None:
        """Call it no longer; raises ValueError if it is unknown."""
        self._pre_set_parameters_callbacks.remove(callback)

    def remove_on_set_parameters_callback(self, callback: _OnSetCallback) -> None:
        """Call it no longer; raises ValueError if it is unknown."""
        self._on_set_parameters_callbacks.remove(callback)

    def remove_post_set_parameters_callback(self, callback: _PostSetCallback) -> None:
        """Call it no longer; raises ValueError if it is unknown."""
        self._post_set_parameters_callbacks.remove(callback)

    def _validate_topic_or_service_name(
        self, topic_or_service_name: str, *, is_service: bool = False
    ) -> None:
        """Raise the exception that says what is wrong with the name."""
        name, namespace = self.get_name(), self.get_namespace()
        validate_node_name(name)
        validate_namespace(namespace)
        validate_topic_name(topic_or_service_name, is_service=is_service)
        expanded = expand_topic_name(topic_or_service_name, name, namespace)
        validate_full_topic_name(expanded, is_service=is_service)

    def _validate_qos_or_depth_parameter(self, qos_or_depth: QoSProfile | int) -> QoSProfile:
        if isinstance(qos_or_depth, QoSProfile):
            return qos_or_depth
        if not isinstance(qos_or_depth, int):
            raise TypeError(f"Expected QoSProfile or int, but received {type(qos_or_depth)!r}")
        if qos_or_depth < 0:
            raise ValueError("history depth must be greater than or equal to zero")
        return QoSProfile(depth=qos_or_depth)

    def resolve_topic_name(self, topic: str, *, only_expand: bool = False) -> str:
        """Return the absolute name of a topic, remapped unless `only_expand`.

        Raises RCLError for a bad name.
        """
        with self.handle:
            return _rclpy.rclpy_resolve_name(self.handle, topic, only_expand, False)

    def resolve_service_name(self, service: str, *, only_expand: bool = False) -> str:
        """Return the absolute name of a service, remapped unless `only_expand`.

        Raises RCLError for a bad name.
        """
        with self.handle:
            return _rclpy.rclpy_resolve_name(self.handle, service, only_expand, True)

    def destroy_node(self) -> None:
        """Destroy the node; a second call does nothing."""
        self._context._nodes.discard(self)
        self._parameter_event_publisher = None
        self._type_description_service.destroy()
        self.handle.destroy_when_not_in_use()

    # The graph around it

    def get_publisher_names_and_types_by_node(
        self, node_name: str, node_namespace: str, no_demangle: bool = False
    ) -> _NamesAndTypes:
        """Return (topic, types) of everything a node publishes."""
        with self.handle:
            return _rclpy.rclpy_get_publisher_names_and_types_by_node(
                self.handle, no_demangle, node_name, node_namespace
            )

    def get_subscriber_names_and_types_by_node(
        self, node_name: str, node_namespace: str, no_demangle: bool = False
    ) -> _NamesAndTypes:
        """Return (topic, types) of everything a node subscribes to."""
        with self.handle:
            return _rclpy.rclpy_get_subscriber_names_and_types_by_node(
                self.handle, no_demangle, node_name, node_namespace
            )

    def get_service_names_and_types_by_node(self, node_name: str, node_namespace: str) -> _NamesAndTypes:
        """Return (service, types) of everything a node serves."""
        with self.handle:
            return _rclpy.rclpy_get_service_names_and_types_by_node(self.handle, node_name, node_namespace)

    def get_client_names_and_types_by_node(self, node_name: str, node_namespace: str) -> _NamesAndTypes:
        """Return (service, types) of everything a node is a client of."""
        with self.handle:
            return _rclpy.rclpy_get_client_names_and_types_by_node(self.handle, node_name, node_namespace)

    def get_topic_names_and_types(self, no_demangle: bool = False) -> _NamesAndTypes:
        """Return (topic, types) of every topic."""
        with self.handle:
            return _rclpy.rclpy_get_topic_names_and_types(self.handle, no_demangle)

    def get_service_names_and_types(self) -> _NamesAndTypes:
        """Return (service, types) of every service."""
        with self.handle:
            return _rclpy.rclpy_get_service_names_and_types(self.handle)

    def get_node_names(self) -> list[str]:
        """Return the name of every node, without namespaces."""
        return [name for name, _ in self.get_node_names_and_namespaces()]

    def get_fully_qualified_node_names(self) -> list[str]:
        """Return the full name of every node."""
        return [
            namespace + name if namespace.endswith("/") else f"{namespace}/{name}"
            for name, namespace in self.get_node_names_and_namespaces()
        ]

    def get_node_names_and_namespaces(self) -> list[tuple[str, str]]:
        """Return (name, namespace) of every node."""
        with self.handle:
            return self.handle.get_node_names_and_namespaces()

    def get_node_names_and_namespaces_with_enclaves(self) -> list[tuple[str, str, str]]:
        """Return (name, namespace, enclave) of every node."""
        with self.handle:
            return self.handle.get_node_names_and_namespaces_with_enclaves()

    def count_publishers(self, topic_name: str) -> int:
        """Count the publishers of a topic. The name is expanded, not remapped; ValueError if it is bad."""
        with self.handle:
            return self.handle.get_count_publishers(self.__expand_valid(topic_name))

    def count_subscribers(self, topic_name: str) -> int:
        """Count the subscriptions of a topic. The name is expanded, not remapped; ValueError if it is bad."""
        with self.handle:
            return self.handle.get_count_subscribers(self.__expand_valid(topic_name))

    def count_clients(self, service_name: str) -> int:
        """Count the clients of a service. The name is expanded, not remapped; ValueError if it is bad."""
        with self.handle:
            return self.handle.get_count_clients(self.__expand_valid(service_name, is_service=True))

    def count_services(self, service_name: str) -> int:
        """Count the servers of a service. The name is expanded, not remapped; ValueError if it is bad."""
        with self.handle:
            return self.handle.get_count_services(self.__expand_valid(service_name, is_service=True))

    def __expand_valid(self, name: str, *, is_service: bool = False) -> str:
        full_name = expand_topic_name(name, self.get_name(), self.get_namespace())
        validate_full_topic_name(full_name, is_service=is_service)
        return full_name

    def get_publishers_info_by_topic(
        self, topic_name: str, no_mangle: bool = False
    ) -> list[TopicEndpointInfo]:
        """Describe the publishers of a topic; its name is expanded and remapped unless `no_mangle`."""
        return self._get_info_by_topic(topic_name, no_mangle, _rclpy.rclpy_get_publishers_info_by_topic)

    def get_subscriptions_info_by_topic(
        self, topic_name: str, no_mangle: bool = False
    ) -> list[TopicEndpointInfo]:
        """Describe the subscriptions of a topic; its name is expanded and remapped unless `no_mangle`."""
        return self._get_info_by_topic(topic_name, no_mangle, _rclpy.rclpy_get_subscriptions_info_by_topic)

    def _get_info_by_topic(
        self, topic_name: str, no_mangle: bool, query: Callable[[Any, str, bool], list[dict[str, Any]]]
    ) -> list[TopicEndpointInfo]:
        with self.handle:
            if not no_mangle:
                topic_name = _rclpy.rclpy_remap_topic_name(self.handle, self.__expand_valid(topic_name))
            return [TopicEndpointInfo(**info) for info in query(self.handle, topic_name, no_mangle)]

    def get_clients_info_by_service(
        self, service_name: str, no_mangle: bool = False
    ) -> list[ServiceEndpointInfo]:
        """Describe the clients of a service; its name is expanded, but not remapped, unless `no_mangle`."""
        return self.__service_endpoints(service_name, no_mangle, _rclpy.rclpy_get_clients_info_by_service)

    def get_servers_info_by_service(
        self, service_name: str, no_mangle: bool = False
    ) -> list[ServiceEndpointInfo]:
        """Describe the servers of a service; its name is expanded, but not remapped, unless `no_mangle`."""
        return self.__service_endpoints(service_name, no_mangle, _rclpy.rclpy_get_servers_info_by_service)

    def __service_endpoints(
        self, service_name: str, no_mangle: bool, query: Callable[[Any, str], list[dict[str, Any]]]
    ) -> list[ServiceEndpointInfo]:
        from rclpy.impl.newer import ServiceEndpointInfo  # late: few programs ask

        distro.uses("service_endpoints")
        name = service_name if no_mangle else self.__expand_valid(service_name, is_service=True)
        with self.handle:
            return [ServiceEndpointInfo(**info) for info in query(self.handle, name)]

    def get_action_names_and_types(self) -> _NamesAndTypes:
        """Return (action, types) of every action that has a server or a client."""
        distro.uses("action_graph")
        with self.handle:
            return self.handle.get_action_names_and_types()

    def get_action_client_names_and_types_by_node(
        self, node_name: str, node_namespace: str
    ) -> _NamesAndTypes:
        """Return (action, types) of everything that a node has action clients for."""
        distro.uses("action_graph")
        with self.handle:
            return self.handle.get_action_client_names_and_types_by_node(node_name, node_namespace)

    def get_action_server_names_and_types_by_node(
        self, node_name: str, node_namespace: str
    ) -> _NamesAndTypes:
        """Return (action, types) of every action that a node serves."""
        distro.uses("action_graph")
        with self.handle:
            return self.handle.get_action_server_names_and_types_by_node(node_name, node_namespace)


class Node(Block, _BaseNode):
    """A node: the unit of naming, ownership and parameters.

    `cli_args` are arguments for this node alone and win over those of the process, which
    `use_global_arguments=False` ignores. `parameter_overrides` win over values from arguments and files. With
    `enable_logger_service` other nodes can read and set logger levels. `rosout_qos_profile` may be a depth.

    Entities may be created and destroyed on any thread, also while the node spins: lists change by single
    operations, and the executor is woken after each.
    """

    _ros_entity = "Node"
    _ros_end = "destroy_node"

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
        """Raises NotInitializedException, InvalidNodeNameException, InvalidNamespaceException, RCLError."""
        self._publishers: list[Publisher[Any]] = []
        self._subscriptions: list[Subscription[Any]] = []
        self._clients: list[Client] = []
        self._services: list[Service] = []
        self._timers: list[Timer] = []
        self._guards: list[GuardCondition] = []
        self.__waitables: list[Waitable] = []
        self._default_callback_group = MutuallyExclusiveCallbackGroup()
        self._rate_group = ReentrantCallbackGroup()
        self.__executor_weakref: weakref.ref[Executor] | None = None
        super().__init__(
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

    # What it owns

    @property
    def publishers(self) -> Iterator[Publisher[Any]]:
        """Iterate over the publishers of this node."""
        yield from self._publishers

    @property
    def subscriptions(self) -> Iterator[Subscription[Any]]:
        """Iterate over the subscriptions of this node."""
        yield from self._subscriptions

    @property
    def clients(self) -> Iterator[Client]:
        """Iterate over the service clients of this node."""
        yield from self._clients

    @property
    def services(self) -> Iterator[Service]:
        """Iterate over the services of this node."""
        yield from self._services

    @property
    def timers(self) -> Iterator[Timer]:
        """Iterate over the timers of this node."""
        yield from self._timers

    @property
    def guards(self) -> Iterator[GuardCondition]:
        """Iterate over the guard conditions of this node."""
        yield from self._guards

    @property
    def waitables(self) -> Iterator[Waitable]:
        """Iterate over the waitables of this node: QoS events, actions, and those that users added."""
        yield from self.__waitables

    @property
    def executor(self) -> Executor | None:
        """The executor that the node belongs to; setting it takes the node out of the one before."""
        return None if self.__executor_weakref is None else self.__executor_weakref()

    @executor.setter
    def executor(self, new_executor: Executor | None) -> None:
        current = self.executor
        if current == new_executor:
            return
        if current is not None:
            current.remove_node(self)
        if new_executor is None:
            self.__executor_weakref = None
        else:
            new_executor.add_node(self)
            self.__executor_weakref = weakref.ref(new_executor)

    def _wake_executor(self) -> None:
        """Let the executor see that the node's entities have changed."""
        executor = self.executor
        if executor is not None:
            executor.wake()

    @property
    def default_callback_group(self) -> CallbackGroup:
        """The mutually exclusive group of every entity that was created without one."""
        return self._default_callback_group

    def add_waitable(self, waitable: Waitable) -> None:
        """Let the executor wait for something beyond the node's own entities."""
        self.__waitables.append(waitable)
        self._wake_executor()

    def remove_waitable(self, waitable: Waitable) -> None:
        """Stop waiting for it; raises ValueError for one that was never added."""
        self.__waitables.remove(waitable)
        self._wake_executor()

    # Creating and destroying what it owns

    def __declare_qos_overrides(
        self, kind: Any, topic: str, profile: QoSProfile, options: QoSOverridingOptions | None
    ) -> None:
        """Let parameters change the profile in place, as the options allow."""
        final_topic = self.__resolve_valid_topic(topic)
        if options is not None:
            _declare_qos_parameters(kind, self, final_topic, profile, options)

    def __resolve_valid_topic(self, topic: str) -> str:
        try:
            return self.resolve_topic_name(topic)
        except RuntimeError:
            try:
                self._validate_topic_or_service_name(topic)
            except InvalidTopicNameException as error:
                raise error from None
            raise

    def create_publisher(
        self,
        msg_type: type[MessageT],
        topic: str,
        qos_profile: QoSProfile | int,
        *,
        callback_group: CallbackGroup | None = None,
        event_callbacks: PublisherEventCallbacks | None = None,
        qos_overriding_options: QoSOverridingOptions | None = None,
        publisher_class: type[Publisher[MessageT]] = Publisher,
    ) -> Publisher[MessageT]:
        """Create a publisher of `msg_type` on `topic`.

        `qos_profile` may be a history depth. `callback_group` is for its QoS events. `qos_overriding_options`
        lets parameters change the profile.
        """
        profile = self._validate_qos_or_depth_parameter(qos_profile)
        self.__declare_qos_overrides(Publisher, topic, profile, qos_overriding_options)
        check_is_valid_msg_type(msg_type)
        msg_type = _class_of(msg_type)
        handle = self.__create_handle(_rclpy.Publisher, msg_type, topic, profile, is_service=False)
        try:
            publisher = publisher_class(
                handle,
                msg_type,
                topic,
                profile,
                event_callbacks=event_callbacks or PublisherEventCallbacks(),
                callback_group=callback_group or self.default_callback_group,
            )
        except Exception:
            handle.destroy_when_not_in_use()
            raise
        self._publishers.append(publisher)
        self.__own_events_of(publisher)
        return publisher

    @overload
    def create_subscription(
        self,
        msg_type: HasViews[ViewsT],
        topic: str,
        callback: MessageCallback[ViewsT],
        qos_profile: QoSProfile | int,
        *,
        callback_group: CallbackGroup | None = None,
        event_callbacks: SubscriptionEventCallbacks | None = None,
        qos_overriding_options: QoSOverridingOptions | None = None,
        raw: Literal[False] = False,
        content_filter_options: ContentFilterOptions | None = None,
        acceptable_buffer_backends: str | None = "cpu",
        views: Literal[True],
    ) -> Subscription[ViewsT]: ...
    @overload
    def create_subscription(
        self,
        msg_type: HasViews[ViewsT],
        topic: str,
        callback: InfoCallback[ViewsT],
        qos_profile: QoSProfile | int,
        *,
        callback_group: CallbackGroup | None = None,
        event_callbacks: SubscriptionEventCallbacks | None = None,
        qos_overriding_options: QoSOverridingOptions | None = None,
        raw: Literal[False] = False,
        content_filter_options: ContentFilterOptions | None = None,
        acceptable_buffer_backends: str | None = "cpu",
        views: Literal[True],
    ) -> Subscription[ViewsT]: ...
    @overload
    def create_subscription(
        self,
        msg_type: type[MessageT],
        topic: str,
        callback: MessageCallback[MessageT],
        qos_profile: QoSProfile | int,
        *,
        callback_group: CallbackGroup | None = None,
        event_callbacks: SubscriptionEventCallbacks | None = None,
        qos_overriding_options: QoSOverridingOptions | None = None,
        raw: Literal[False] = False,
        content_filter_options: ContentFilterOptions | None = None,
        acceptable_buffer_backends: str | None = "cpu",
        views: bool = False,
    ) -> Subscription[MessageT]: ...
    @overload
    def create_subscription(
        self,
        msg_type: type[MessageT],
        topic: str,
        callback: InfoCallback[MessageT],
        qos_profile: QoSProfile | int,
        *,
        callback_group: CallbackGroup | None = None,
        event_callbacks: SubscriptionEventCallbacks | None = None,
        qos_overriding_options: QoSOverridingOptions | None = None,
        raw: Literal[False] = False,
        content_filter_options: ContentFilterOptions | None = None,
        acceptable_buffer_backends: str | None = "cpu",
        views: bool = False,
    ) -> Subscription[MessageT]: ...
    @overload
    def create_subscription(
        self,
        msg_type: type[MessageT],
        topic: str,
        callback: MessageCallback[bytes] | InfoCallback[bytes],
        qos_profile: QoSProfile | int,
        *,
        callback_group: CallbackGroup | None = None,
        event_callbacks: SubscriptionEventCallbacks | None = None,
        qos_overriding_options: QoSOverridingOptions | None = None,
        raw: Literal[True],
        content_filter_options: ContentFilterOptions | None = None,
        acceptable_buffer_backends: str | None = "cpu",
    ) -> Subscription[MessageT]: ...
    def create_subscription(
        self,
        msg_type: Any,
        topic: str,
        callback: Callable[..., Any],
        qos_profile: QoSProfile | int,
        *,
        callback_group: CallbackGroup | None = None,
        event_callbacks: SubscriptionEventCallbacks | None = None,
        qos_overriding_options: QoSOverridingOptions | None = None,
        raw: bool = False,
        content_filter_options: ContentFilterOptions | None = None,
        acceptable_buffer_backends: str | None = "cpu",
        views: bool = False,
    ) -> Subscription[Any]:
        """Create a subscription to `topic`; `callback` gets the message, and its info if it takes two.

        `qos_profile` may be a history depth. With `raw` the callback gets serialized bytes. Messages that
        `content_filter_options` do not accept never come. All memory is the CPU's here, so
        `acceptable_buffer_backends` changes nothing. With `views`,
        which only the local transport has, sequences of numbers are numpy arrays that show the received
        bytes, as `ifgen_runtime.deserialize(..., views=True)` returns them.
        """
        if raw and views:
            raise ValueError("create_subscription() cannot have raw and views: raw passes bytes")
        if acceptable_buffer_backends != "cpu":
            distro.uses("buffer_backends")
        profile = self._validate_qos_or_depth_parameter(qos_profile)
        self.__declare_qos_overrides(Subscription, topic, profile, qos_overriding_options)
        group = callback_group or self.default_callback_group
        check_is_valid_msg_type(msg_type)
        msg_type = _class_of(msg_type)
        wanted = None if content_filter_options is None else _content_filter(content_filter_options)
        handle = self.__create_handle(_rclpy.Subscription, msg_type, topic, profile, wanted, is_service=False)
        try:
            subscription = Subscription(
                handle,
                msg_type,
                topic,
                callback,
                group,
                profile,
                raw,
                event_callbacks=event_callbacks or SubscriptionEventCallbacks(),
            )
            if views:
                handle.use_views()
        except Exception:
            handle.destroy_when_not_in_use()
            raise
        group.add_entity(subscription)
        self._subscriptions.append(subscription)
        self.__own_events_of(subscription)
        return subscription

    def create_client(
        self,
        srv_type: type[ServiceT_co],
        srv_name: str,
        *,
        qos_profile: QoSProfile = qos_profile_services_default,
        callback_group: CallbackGroup | None = None,
    ) -> Client[ServiceT_co]:
        """Create a client of the service `srv_name`."""
        group = self.default_callback_group if callback_group is None else callback_group
        check_is_valid_srv_type(srv_type)
        handle = self.__create_handle(_rclpy.Client, srv_type, srv_name, qos_profile, is_service=True)
        client = Client(self.context, handle, srv_type, srv_name, qos_profile, group)
        return self.__own(client, self._clients, group)

    def create_service(
        self,
        srv_type: ServiceClass[ServiceT_co, RequestT, ResponseT],
        srv_name: str,
        callback: Callable[[RequestT, ResponseT], MaybeAsync[ResponseT]],
        *,
        qos_profile: QoSProfile = qos_profile_services_default,
        callback_group: CallbackGroup | None = None,
    ) -> Service[ServiceT_co]:
        """Serve `srv_name`: `callback(request, response)` returns the response."""
        check_is_valid_srv_type(srv_type)
        handle = self.__create_handle(_rclpy.Service, srv_type, srv_name, qos_profile, is_service=True)
        return self._create_service(handle, srv_type, srv_name, callback, qos_profile, callback_group)

    def _create_service(
        self,
        handle: _rclpy.Service,
        srv_type: Any,
        srv_name: str,
        callback: Callable[[Any, Any], Any],
        qos_profile: QoSProfile,
        callback_group: CallbackGroup | None = None,
    ) -> Service[Any]:
        """Own a service whose handle is there."""
        group = self.default_callback_group if callback_group is None else callback_group
        service: Service[Any] = Service(handle, srv_type, srv_name, callback, group, qos_profile)
        return self.__own(service, self._services, group)

    def create_timer(
        self,
        timer_period_sec: float,
        callback: Callable[[], object] | None,
        callback_group: CallbackGroup | None = None,
        clock: Clock | None = None,
        autostart: bool = True,
    ) -> Timer:
        """Call `callback` every `timer_period_sec` [s] of `clock`, the node's own by default."""
        period = int(float(timer_period_sec) * S_TO_NS)
        group = self.default_callback_group if callback_group is None else callback_group
        timer = Timer(
            callback,
            group,
            period,
            self._clock if clock is None else clock,
            context=self.context,
            autostart=autostart,
        )
        return self.__own(timer, self._timers, group)

    def create_guard_condition(
        self,
        callback: Callable[[], object],
        callback_group: CallbackGroup | None = None,
    ) -> GuardCondition:
        """Call `callback` in the executor whenever the guard condition is triggered."""
        group = self.default_callback_group if callback_group is None else callback_group
        guard = GuardCondition(callback, group, context=self.context)
        return self.__own(guard, self._guards, group)

    def create_rate(self, frequency: float, clock: Clock | None = None) -> Rate:
        """Create something to sleep on `frequency` [Hz] times a second; raises ValueError unless positive."""
        if frequency <= 0:
            raise ValueError("frequency must be > 0")
        timer = self.create_timer(1.0 / frequency, None, self._rate_group, clock)
        return Rate(timer, context=self.context)

    def __create_handle(
        self, kind: Any, interface: Any, name: str, qos_profile: QoSProfile, *more: Any, is_service: bool
    ) -> Any:
        try:
            with self.handle:
                return kind(self.handle, interface, name, qos_profile.get_c_qos_profile(), *more)
        except ValueError:
            self._validate_topic_or_service_name(name, is_service=is_service)
            raise

    def __own(self, entity: _Entity, owned: list[_Entity], group: CallbackGroup) -> _Entity:
        group.add_entity(entity)
        owned.append(entity)
        self.__be_told_by(entity)
        self._wake_executor()
        return entity

    def __be_told_by(self, entity: Any) -> None:
        """Have `_forget` called when the entity is destroyed, as newer ROS does."""
        if distro.follows("destroy"):
            entity._owner = weakref.ref(self)

    def _forget(self, entity: Any) -> None:
        """Own an entity no longer that was destroyed."""
        for owned in (self._publishers, self._subscriptions, self._clients, self._services, self._timers):
            with suppress(ValueError):
                owned.remove(entity)
        for handler in getattr(entity, "event_handlers", ()):
            with suppress(ValueError):
                self.remove_waitable(handler)
        self._wake_executor()

    def __own_events_of(self, endpoint: Publisher[Any] | Subscription[Any]) -> None:
        self.__be_told_by(endpoint)
        self._wake_executor()
        for handler in endpoint.event_handlers:
            self.add_waitable(handler)

    def destroy_publisher(self, publisher: Publisher[Any]) -> bool:
        """Destroy a publisher of this node; False if it is not one."""
        return self.__destroy(publisher, self._publishers)

    def destroy_subscription(self, subscription: Subscription[Any]) -> bool:
        """Destroy a subscription of this node; False if it is not one."""
        return self.__destroy(subscription, self._subscriptions)

    def destroy_client(self, client: Client) -> bool:
        """Destroy a client of this node; False if it is not one."""
        return self.__destroy(client, self._clients)

    def destroy_service(self, service: Service) -> bool:
        """Destroy a service of this node; False if it is not one."""
        return self.__destroy(service, self._services)

    def destroy_timer(self, timer: Timer) -> bool:
        """Destroy a timer of this node; False if it is not one."""
        return self.__destroy(timer, self._timers)

    def destroy_guard_condition(self, guard: GuardCondition) -> bool:
        """Destroy a guard condition of this node; False if it is not one."""
        return self.__destroy(guard, self._guards)

    def destroy_rate(self, rate: Rate) -> bool:
        """Destroy a rate of this node. Threads that sleep on it wake with an exception."""
        destroyed = self.destroy_timer(rate._timer)
        rate.destroy()
        return destroyed

    def __destroy(self, entity: Any, owned: list[Any]) -> bool:
        try:
            owned.remove(entity)
        except ValueError:
            return False
        for handler in getattr(entity, "event_handlers", ()):
            self.remove_waitable(handler)
        try:
            entity.destroy()
        except InvalidHandle:
            return False
        self._wake_executor()
        return True

    def destroy_node(self) -> None:
        """Destroy the node and everything it created; a second call does nothing."""
        owned: tuple[tuple[list[Any], Callable[[Any], bool]], ...] = (
            (self._publishers, self.destroy_publisher),
            (self._subscriptions, self.destroy_subscription),
            (self._clients, self.destroy_client),
            (self._services, self.destroy_service),
            (self._timers, self.destroy_timer),
            (self._guards, self.destroy_guard_condition),
        )
        for entities, destroy in owned:
            while entities:
                for entity in list(entities):
                    destroy(entity)
        super().destroy_node()
        self._wake_executor()

    def wait_for_node(self, fully_qualified_node_name: str, timeout: float) -> bool:
        """Wait up to `timeout` [s] until a node is there; False if it does not come."""
        if not fully_qualified_node_name.startswith("/"):
            fully_qualified_node_name = f"/{fully_qualified_node_name}"
        if timeout <= 0:
            return False
        return wait_for_graph(
            self.handle, lambda: fully_qualified_node_name in self.get_fully_qualified_node_names(), timeout
        )
