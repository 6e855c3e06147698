"""The services through which others reach a node's parameters."""

from __future__ import annotations

import weakref
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from rcl_interfaces.msg import ListParametersResult, SetParametersResult
from rcl_interfaces.srv import (
    DescribeParameters,
    GetParameters,
    GetParameterTypes,
    ListParameters,
    SetParameters,
    SetParametersAtomically,
)

from rclpy.exceptions import ParameterNotDeclaredException, ParameterUninitializedException
from rclpy.impl.messages import cleaned
from rclpy.parameter import Parameter
from rclpy.qos import qos_profile_parameters
from rclpy.validate_topic_name import TOPIC_SEPARATOR_STRING

if TYPE_CHECKING:
    from rclpy.node import _BaseNode as BaseNode


class ParameterService:
    """Six services of a node under its own name. It holds the node weakly, because the node holds it."""

    def __init__(self, node: BaseNode) -> None:
        self._node_weak_ref = weakref.ref(node)
        node_name = node.get_name()
        services: tuple[tuple[Any, str, Callable[[Any, Any], Any]], ...] = (
            (DescribeParameters, "describe_parameters", self._describe_parameters_callback),
            (GetParameters, "get_parameters", self._get_parameters_callback),
            (GetParameterTypes, "get_parameter_types", self._get_parameter_types_callback),
            (ListParameters, "list_parameters", self._list_parameters_callback),
            (SetParameters, "set_parameters", self._set_parameters_callback),
            (SetParametersAtomically, "set_parameters_atomically", self._set_parameters_atomically_callback),
        )
        for service_type, name, callback in services:
            full_name = TOPIC_SEPARATOR_STRING.join((node_name, name))
            node.create_service(
                service_type, full_name, _with_clean_texts(callback), qos_profile=qos_profile_parameters
            )

    # One unknown name empties the whole answer: that is how a client learns of it.

    def _describe_parameters_callback(self, request: Any, response: Any) -> Any:
        node = self._get_node()
        try:
            response.descriptors = [node.describe_parameter(name) for name in request.names]
        except ParameterNotDeclaredException:
            response.descriptors = []
        return response

    def _get_parameters_callback(self, request: Any, response: Any) -> Any:
        node = self._get_node()
        try:
            response.values = [node.get_parameter(name).get_parameter_value() for name in request.names]
        except (ParameterNotDeclaredException, ParameterUninitializedException):
            response.values = []
        return response

    def _get_parameter_types_callback(self, request: Any, response: Any) -> Any:
        node = self._get_node()
        try:
            types = [node.get_parameter_type(name) for name in request.names]
        except ParameterNotDeclaredException:
            types = []
        response.types = [type_.value if isinstance(type_, Parameter.Type) else type_ for type_ in types]
        return response

    def _list_parameters_callback(self, request: Any, response: Any) -> Any:
        try:
            response.result = self._get_node().list_parameters(request.prefixes, request.depth)
        except (TypeError, ValueError):
            response.result = ListParametersResult()
        return response

    def _set_parameters_callback(self, request: Any, response: Any) -> Any:
        response.results = [self._set([message]) for message in request.parameters]
        return response

    def _set_parameters_atomically_callback(self, request: Any, response: Any) -> Any:
        response.result = self._set(request.parameters)
        return response

    def _set(self, messages: Any) -> SetParametersResult:
        parameters = [Parameter.from_parameter_msg(message) for message in messages]
        node = self._get_node()
        try:
            result = node.set_parameters_atomically(parameters)
        except ParameterNotDeclaredException as error:
            result = SetParametersResult(successful=False, reason=str(error))
        if not result.successful:
            names = ", ".join(parameter.name for parameter in parameters)
            node.get_logger().warning(
                f"Parameters that another node asked to set stay: {names}: {result.reason}"
            )
        return result

    def _get_node(self) -> BaseNode:
        node = self._node_weak_ref()
        if node is None:
            raise ReferenceError("Expected valid node weak reference")
        return node


def _with_clean_texts(callback: Callable[[Any, Any], Any]) -> Callable[[Any, Any], Any]:
    return lambda request, response: cleaned(callback(request, response))
