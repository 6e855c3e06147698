"""Reading and setting the parameters of another node."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

from rcl_interfaces.msg import Parameter as ParameterMsg
from rcl_interfaces.msg import ParameterEvent
from rcl_interfaces.srv import (
    DescribeParameters,
    GetParameters,
    GetParameterTypes,
    ListParameters,
    SetParameters,
    SetParametersAtomically,
)

from rclpy.callback_groups import CallbackGroup
from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.impl.blocking import wait_for_graph
from rclpy.impl.messages import cleaned
from rclpy.impl.reexports import reexport
from rclpy.node import Node
from rclpy.parameter import Parameter, parameter_dict_from_yaml_file
from rclpy.qos import QoSProfile, qos_profile_parameter_events, qos_profile_services_default
from rclpy.qos_overriding_options import QoSOverridingOptions
from rclpy.subscription import Subscription
from rclpy.task import Future

if TYPE_CHECKING:
    from rclpy.client import Client
else:
    __getattr__ = reexport(__name__)

Parameters = Sequence[Parameter | ParameterMsg]
Callback = Callable[[Any], Any]


class AsyncParameterClient:
    """The parameters of `remote_node_name`, through services that `node` is a client of.

    Every operation returns a future with the service's response; `callback`, if given, gets the future when
    it is done. An operation on several names has an empty result if one of them is unknown.
    """

    def __init__(
        self,
        node: Node,
        remote_node_name: str,
        qos_profile: QoSProfile = qos_profile_services_default,
        callback_group: CallbackGroup | None = None,
    ) -> None:
        self.remote_node_name = remote_node_name
        self.node = node

        def client(service_type: Any, name: str) -> Client:
            return node.create_client(
                service_type,
                f"{remote_node_name}/{name}",
                qos_profile=qos_profile,
                callback_group=callback_group,
            )

        self._get_parameter_client = client(GetParameters, "get_parameters")
        self._list_parameter_client = client(ListParameters, "list_parameters")
        self._set_parameter_client = client(SetParameters, "set_parameters")
        self._get_parameter_types_client = client(GetParameterTypes, "get_parameter_types")
        self._describe_parameters_client = client(DescribeParameters, "describe_parameters")
        self._set_parameters_atomically_client = client(SetParametersAtomically, "set_parameters_atomically")

    def services_are_ready(self) -> bool:
        """Whether all six services of the remote node are there."""
        return all(
            client.service_is_ready()
            for client in (
                self._list_parameter_client,
                self._set_parameter_client,
                self._get_parameter_client,
                self._get_parameter_types_client,
                self._describe_parameters_client,
                self._set_parameters_atomically_client,
            )
        )

    def wait_for_services(self, timeout_sec: float | None = None) -> bool:
        """Wait until all services are there, at most `timeout_sec` [s] (None: no limit).

        Returns whether they are.
        """
        return wait_for_graph(self.node.handle, self.services_are_ready, timeout_sec)

    def list_parameters(
        self,
        prefixes: list[str] | None = None,
        depth: int | None = None,
        callback: Callback | None = None,
    ) -> Future:
        """List the names below the prefixes; see `Node.list_parameters`."""
        request = ListParameters.Request()
        if prefixes:
            request.prefixes = prefixes
        if depth:
            request.depth = depth
        return _call(self._list_parameter_client, request, callback)

    def get_parameters(self, names: list[str], callback: Callback | None = None) -> Future:
        """Ask for values."""
        return _call(self._get_parameter_client, GetParameters.Request(names=names), callback)

    def set_parameters(self, parameters: Parameters, callback: Callback | None = None) -> Future:
        """Set one parameter after the other; the response has a result for each."""
        request = SetParameters.Request(parameters=_messages(parameters))
        return _call(self._set_parameter_client, request, callback)

    def describe_parameters(self, names: list[str], callback: Callback | None = None) -> Future:
        """Ask for descriptors."""
        request = DescribeParameters.Request(names=names)
        return _call(self._describe_parameters_client, request, callback)

    def get_parameter_types(self, names: list[str], callback: Callback | None = None) -> Future:
        """Ask for types."""
        request = GetParameterTypes.Request(names=names)
        return _call(self._get_parameter_types_client, request, callback)

    def set_parameters_atomically(self, parameters: Parameters, callback: Callback | None = None) -> Future:
        """Set all parameters or none."""
        request = SetParametersAtomically.Request(parameters=_messages(parameters))
        return _call(self._set_parameters_atomically_client, request, callback)

    def delete_parameters(self, names: list[str], callback: Callback | None = None) -> Future:
        """Set parameters to "not set", which removes those with a dynamic type."""
        return self.set_parameters([Parameter(name=name) for name in names], callback)

    def load_parameter_file(
        self,
        parameter_file: str,
        use_wildcard: bool = False,
        callback: Callback | None = None,
    ) -> Future:
        """Set the parameters of a YAML file; those of `/**` only if `use_wildcard`."""
        parameters = parameter_dict_from_yaml_file(parameter_file, use_wildcard)
        return self.set_parameters(list(parameters.values()), callback=callback)

    def load_parameter_file_atomically(
        self,
        parameter_file: str,
        use_wildcard: bool = False,
        callback: Callback | None = None,
    ) -> Future:
        """Set all parameters of a YAML file or none."""
        parameters = parameter_dict_from_yaml_file(parameter_file, use_wildcard)
        return self.set_parameters_atomically(list(parameters.values()), callback=callback)

    def on_parameter_event(
        self,
        callback: Callable[[ParameterEvent], Any],
        qos_profile: QoSProfile = qos_profile_parameter_events,
        *,
        callback_group: CallbackGroup | None = None,
        event_callbacks: SubscriptionEventCallbacks | None = None,
        qos_overriding_options: QoSOverridingOptions | None = None,
        raw: bool = False,
    ) -> Subscription[ParameterEvent]:
        """Subscribe to the parameter events of all nodes."""
        subscribe: Callable[..., Subscription[ParameterEvent]] = self.node.create_subscription  # any `raw`
        return subscribe(
            ParameterEvent,
            "/parameter_events",
            callback,
            qos_profile,
            callback_group=callback_group,
            event_callbacks=event_callbacks,
            qos_overriding_options=qos_overriding_options,
            raw=raw,
        )


def _messages(parameters: Parameters) -> list[ParameterMsg]:
    return [
        parameter.to_parameter_msg() if isinstance(parameter, Parameter) else parameter
        for parameter in parameters
    ]


def _call(client: Client, request: Any, callback: Callback | None) -> Future:
    future = client.call_async(cleaned(request))
    if callback:
        future.add_done_callback(callback)
    return future
