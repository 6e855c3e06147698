"""Declaring and setting a node's parameters, with callbacks and events."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from typing import Any

from rcl_interfaces.msg import (
    ParameterDescriptor,
    ParameterEvent,
    SetParametersResult,
)

from rclpy._node import parameter_rules as rules
from rclpy._node.declarations import read_declaration
from rclpy._node.descriptors import DescribedParameters, Descriptors
from rclpy.exceptions import (
    InvalidParameterTypeException,
    InvalidParameterValueException,
    ParameterAlreadyDeclaredException,
    ParameterImmutableException,
    ParameterNotDeclaredException,
)
from rclpy.parameter import Parameter
from rclpy.publisher import Publisher

PreSetCallback = Callable[[list[Parameter]], list[Parameter]]
OnSetCallback = Callable[[list[Parameter]], SetParametersResult]
PostSetCallback = Callable[[list[Parameter]], None]

_NOT_SET = Parameter.Type.NOT_SET


class ParameterOwner(DescribedParameters):
    """A node with parameters; each change is checked, offered to callbacks and published as an event.

    Callbacks of one kind run newest first. Overrides (from files, arguments and the constructor) replace the
    value that a parameter is declared with.
    """

    _parameter_event_publisher: Publisher[Any] | None

    def __init__(self, node_name: str, **options: Any) -> None:
        super().__init__(node_name, **options)
        self._parameter_overrides: dict[str, Parameter] = {}
        self._pre_set_parameters_callbacks: list[PreSetCallback] = []
        self._on_set_parameters_callbacks: list[OnSetCallback] = []
        self._post_set_parameters_callbacks: list[PostSetCallback] = []

    # Declaring

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
        parameters: list[tuple[str] | tuple[str, Any] | tuple[str, Any, ParameterDescriptor]],
        ignore_override: bool = False,
    ) -> list[Parameter]:
        """Declare several parameters `namespace.name`, one event each; see `declare_parameter`.

        Those before a refused one stay declared. Pre-set callbacks are not called.
        """
        overrides = {} if ignore_override else self._parameter_overrides
        declarations = [
            read_declaration(index, entry, namespace, overrides) for index, entry in enumerate(parameters)
        ]
        names = [parameter.name for parameter, _ in declarations]
        if known := [name for name in names if name in self._parameters]:
            raise ParameterAlreadyDeclaredException(known)
        self._declare_parameter_common(
            [parameter for parameter, _ in declarations],
            {parameter.name: descriptor for parameter, descriptor in declarations},
        )
        return [self._parameters[name] for name in names]

    def _declare_parameter_common(
        self,
        parameter_list: list[Parameter],
        descriptors: Descriptors | None = None,
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

    # Setting

    def set_parameters(self, parameter_list: list[Parameter]) -> list[SetParametersResult]:
        """Set one parameter after the other and return a result for each.

        Raises ParameterNotDeclaredException; those before are set then.
        """
        return [self._set_parameters_atomically([parameter]) for parameter in parameter_list]

    def set_parameters_atomically(self, parameter_list: list[Parameter]) -> SetParametersResult:
        """Set all parameters or none; raises ParameterNotDeclaredException."""
        return self._set_parameters_atomically(parameter_list)

    def _set_parameters_atomically(self, parameter_list: list[Parameter]) -> SetParametersResult:
        if self._pre_set_parameters_callbacks:
            parameter_list = [
                parameter
                for callback in self._pre_set_parameters_callbacks
                for parameter in callback(parameter_list)
            ]
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

    def _set_parameters_atomically_common(
        self,
        parameter_list: list[Parameter],
        descriptors: Descriptors | None = None,
        allow_not_set_type: bool = False,
    ) -> SetParametersResult:
        """Check, ask, set, publish, tell. `descriptors` come with a declaration."""
        declaring = descriptors is not None
        result = self._apply_descriptors(
            parameter_list, self._descriptors if descriptors is None else descriptors, not declaring
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
            self.__store(parameter, descriptors, allow_not_set_type, event)
        event.stamp = self._clock.now().to_msg()
        if self._parameter_event_publisher is not None:
            self._parameter_event_publisher.publish(event)
        for post_set in list(self._post_set_parameters_callbacks):
            post_set(parameter_list)
        return rules.accepted()

    def __store(
        self,
        parameter: Parameter,
        descriptors: Descriptors | None,
        allow_not_set_type: bool,
        event: ParameterEvent,
    ) -> None:
        """Keep, replace or remove one parameter and write that into the event."""
        name = parameter.name
        if parameter.type_ is _NOT_SET and not allow_not_set_type:
            event.deleted_parameters.append(parameter.to_parameter_msg())
            self._parameters.pop(name, None)
            self._descriptors.pop(name, None)
            return
        if descriptors is not None:
            self._descriptors[name] = descriptors[name]
        elif name not in self._descriptors:
            self._descriptors[name] = ParameterDescriptor(dynamic_typing=True)
        is_new = self.get_parameter_or(name).type_ is _NOT_SET
        (event.new_parameters if is_new else event.changed_parameters).append(parameter.to_parameter_msg())
        self._parameters[name] = parameter

    # Callbacks

    def add_pre_set_parameters_callback(self, callback: PreSetCallback) -> None:
        """Let `callback` change the list of parameters before it is checked; it returns the new list."""
        self._pre_set_parameters_callbacks.insert(0, callback)

    def add_on_set_parameters_callback(self, callback: OnSetCallback) -> None:
        """Let `callback` refuse parameters: it returns a SetParametersResult.

        Raises TypeError unless callable.
        """
        if not callable(callback):
            raise TypeError("Callback must be callable, got {}", type(callback))
        self._on_set_parameters_callbacks.insert(0, callback)

    def add_post_set_parameters_callback(self, callback: PostSetCallback) -> None:
        """Tell `callback` about parameters that were set. Raises TypeError unless callable."""
        if not callable(callback):
            raise TypeError("Callback must be callable, got {}", type(callback))
        self._post_set_parameters_callbacks.insert(0, callback)

    def remove_pre_set_parameters_callback(self, callback: PreSetCallback) -> None:
        """Call it no longer; raises ValueError if it is unknown."""
        self._pre_set_parameters_callbacks.remove(callback)

    def remove_on_set_parameters_callback(self, callback: OnSetCallback) -> None:
        """Call it no longer; raises ValueError if it is unknown."""
        self._on_set_parameters_callbacks.remove(callback)

    def remove_post_set_parameters_callback(self, callback: PostSetCallback) -> None:
        """Call it no longer; raises ValueError if it is unknown."""
        self._post_set_parameters_callbacks.remove(callback)
