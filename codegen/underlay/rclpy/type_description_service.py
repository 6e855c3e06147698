"""`~/get_type_description`: each node can describe the types that it uses."""

from __future__ import annotations

import weakref
from typing import TYPE_CHECKING, Any

from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy
from rclpy.impl.reexports import reexport
from rclpy.parameter import Parameter
from rclpy.qos import qos_profile_services_default
from rclpy.service import Service
from rclpy.validate_topic_name import TOPIC_SEPARATOR_STRING

if TYPE_CHECKING:
    from rclpy.node import Node

if not TYPE_CHECKING:
    __getattr__ = reexport(__name__)

START_TYPE_DESCRIPTION_SERVICE_PARAM = "start_type_description_service"


class TypeDescriptionService:
    """Starts the service of a node unless the parameter `start_type_description_service` forbids it."""

    def __init__(self, node: Node) -> None:
        self._node_weak_ref = weakref.ref(node)
        self.service_name: str = TOPIC_SEPARATOR_STRING.join((node.get_name(), "get_type_description"))
        self._type_description_srv: _rclpy.TypeDescriptionService | None = None
        self.enabled: bool = self._is_wanted(node)
        if self.enabled:
            self._start_service()

    def destroy(self) -> None:
        """End the service."""
        if self._type_description_srv is not None:
            self._type_description_srv.destroy_when_not_in_use()
            self._type_description_srv = None

    def _is_wanted(self, node: Node) -> bool:
        if not node.has_parameter(START_TYPE_DESCRIPTION_SERVICE_PARAM):
            from rcl_interfaces.msg import (  # generated: not needed to import rclpy
                ParameterDescriptor,
                ParameterType,
            )

            descriptor = ParameterDescriptor(
                name=START_TYPE_DESCRIPTION_SERVICE_PARAM,
                type=ParameterType.PARAMETER_BOOL,
                description="If enabled, start the ~/get_type_description service.",
                read_only=True,
            )
            node.declare_parameter(START_TYPE_DESCRIPTION_SERVICE_PARAM, True, descriptor)
        parameter = node.get_parameter(START_TYPE_DESCRIPTION_SERVICE_PARAM)
        if parameter.type_ is Parameter.Type.BOOL:
            return bool(parameter.value)
        if parameter.type_ is Parameter.Type.NOT_SET:
            node.get_logger().debug(
                f"Parameter {START_TYPE_DESCRIPTION_SERVICE_PARAM} not set, defaulting to true."
            )
        else:
            node.get_logger().error(
                f"Invalid type for parameter '{START_TYPE_DESCRIPTION_SERVICE_PARAM}' {parameter.type_!r} "
                "should be bool"
            )
        return False

    def _start_service(self) -> None:
        from type_description_interfaces.srv import (
            GetTypeDescription,  # generated: not needed to import rclpy
        )

        node = self._get_node()
        self._type_description_srv = _rclpy.TypeDescriptionService(node.handle)
        service = Service(
            service_impl=self._type_description_srv.impl,
            srv_type=GetTypeDescription,
            srv_name=self.service_name,
            callback=self._service_callback,
            callback_group=node.default_callback_group,
            qos_profile=qos_profile_services_default,
        )
        # The handle exists already, so `Node.create_service` cannot be used.
        node.default_callback_group.add_entity(service)
        node._services.append(service)
        node._wake_executor()

    def _service_callback(self, request: Any, response: Any) -> Any:
        assert self._type_description_srv is not None
        return self._type_description_srv.handle_request(request, type(response), self._get_node().handle)

    def _get_node(self) -> Node:
        node = self._node_weak_ref()
        if node is None:
            raise ReferenceError("Expected valid node weak reference")
        return node
