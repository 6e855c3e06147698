"""The parameters of a node: declared, described, read, set, observed."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from typing import Any

from rcl_interfaces.msg import (
    FloatingPointRange,
    IntegerRange,
    ListParametersResult,
    ParameterDescriptor,
    ParameterEvent,
    ParameterValue,
    SetParametersResult,
)
from rcl_interfaces.msg import Parameter as ParameterMsg

from rclpy._node import parameter_rules as rules
from rclpy._node.base import NodeBase
from rclpy._node.declarations import read_declaration
from rclpy.exceptions import (
    InvalidParameterTypeException,
    InvalidParameterValueException,
    ParameterAlreadyDeclaredException,
    ParameterImmutableException,
    ParameterNotDeclaredException,
    ParameterUninitializedException,
)
from rclpy.parameter import PARAMETER_SEPARATOR_STRING, Parameter
from rclpy.publisher import Publisher

PreSetCallback = Callable[[list[Parameter]], list[Parameter]]
OnSetCallback = Callable[[list[Parameter]], SetParametersResult]
PostSetCallback = Callable[[list[Parameter]], None]
Descriptors = dict[str, ParameterDescriptor]

_NOT_SET = Parameter.Type.NOT_SET


class ParameterOwner(NodeBase):
    """A node with parameters; each change is checked, offered to callbacks and published as an event.

    Callbacks of one kind run newest first. Overrides (from files, arguments and the constructor) replace the
    value that a parameter is declared with.
    """

    PARAM_REL_TOL = rules.RELATIVE_TOLERANCE

    _parameter_event_publisher: Publisher[Any] | None

    def _init_parameters(self, *, allow_undeclared: bool) -> None:
        self._parameters: dict[str, Parameter] = {}
        self._descriptors: Descriptors = {}
        self._parameter_overrides: dict[str, Parameter] = {}
        self._pre_set_parameters_callbacks: list[PreSetCallback] = []
        self._on_set_parameters_callbacks: list[OnSetCallback] = []
        self._post_set_parameters_callbacks: list[PostSetCallback] = []
        self._allow_undeclared_parameters = allow_undeclared

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

    def has_parameter(self, name: str) -> bool:
        """Whether the parameter is declared."""
        return name in self._parameters

    # Reading

    def get_parameter_types(self, names: list[str]) -> list[Any]:
        """Return the type of each parameter; see `get_parameter_type`."""
        _check_strings(names)
        return [self.get_parameter_type(name) for name in names]

    def get_parameter_type(self, name: str) -> Any:
        """Return the number of a parameter's type; raises ParameterNotDeclaredException."""
        if self.has_parameter(name):
            return self._parameters[name].type_.value
        if self._allow_undeclared_parameters:
            return _NOT_SET
        raise ParameterNotDeclaredException(name)

    def get_parameters(self, names: list[str]) -> list[Parameter]:
        """Return each parameter; see `get_parameter`."""
        _check_strings(names)
        return [self.get_parameter(name) for name in names]

    def get_parameter(self, name: str) -> Parameter:
        """Return a parameter; raises ParameterNotDeclaredException, or ParameterUninitializedException.

        Where undeclared parameters are allowed, they are returned as not set.
        """
        parameter = self._parameters.get(name)
        if parameter is None:
            if self._allow_undeclared_parameters:
                return Parameter(name, _NOT_SET, None)
            raise ParameterNotDeclaredException(name)
        if parameter.type_ is _NOT_SET and not self._descriptors[name].dynamic_typing:
            raise ParameterUninitializedException(name)
        return parameter

    def get_parameter_or(self, name: str, alternative_value: Parameter | None = None) -> Parameter:
        """Return a parameter, or the alternative (by default one that is not set) if it has no value."""
        parameter = self._parameters.get(name)
        if parameter is not None and parameter.type_ is not _NOT_SET:
            return parameter
        return Parameter(name, _NOT_SET) if alternative_value is None else alternative_value

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
        if not isinstance(prefixes, list):
            raise TypeError("The prefixes argument must be a list")
        if not all(isinstance(prefix, str) for prefix in prefixes):
            raise TypeError("All prefixes must be instances of type str")
        if not isinstance(depth, int):
            raise TypeError("The depth must be instance of type int")
        if depth < 0:
            raise ValueError("The depth must be greater than or equal to zero")
        names = [name for name in list(self._parameters) if _is_listed(name, prefixes, depth)]
        parents = [name.rpartition(PARAMETER_SEPARATOR_STRING)[0] for name in names]
        return ListParametersResult(
            names=names, prefixes=list(dict.fromkeys(parent for parent in parents if parent))
        )

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
            self._store(parameter, descriptors, allow_not_set_type, event)
        event.stamp = self._clock.now().to_msg()
        if self._parameter_event_publisher is not None:
            self._parameter_event_publisher.publish(event)
        for post_set in list(self._post_set_parameters_callbacks):
            post_set(parameter_list)
        return rules.accepted()

    def _store(
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

    # Descriptors

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
        if not self._apply_descriptor_and_set(current, descriptor, False).successful:
            result = self._apply_descriptor_and_set(alternative, descriptor, False)
            if not result.successful:
                raise InvalidParameterValueException(name, alternative.value, result.reason)
        self._descriptors[name] = descriptor
        return self.get_parameter(name).get_parameter_value()

    def _apply_descriptors(
        self, parameter_list: list[Parameter], descriptors: Descriptors, check_read_only: bool = True
    ) -> SetParametersResult:
        for parameter in parameter_list:
            if parameter.name in descriptors:
                result = self._apply_descriptor(parameter, descriptors[parameter.name], check_read_only)
                if not result.successful:
                    return result
        return rules.accepted()

    def _apply_descriptor(
        self,
        parameter: Parameter,
        descriptor: ParameterDescriptor | None = None,
        check_read_only: bool = True,
    ) -> SetParametersResult:
        """Check a value.

        A descriptor that is given takes over the parameter's name, and its type if dynamic.
        """
        if descriptor is None:
            descriptor = self.describe_parameter(parameter.name)
        else:
            descriptor.name = parameter.name
        if check_read_only and descriptor.read_only:
            return rules.refused(f"Trying to set a read-only parameter: {parameter.name}.")
        if descriptor.dynamic_typing:
            descriptor.type = parameter.type_.value
        elif fault := rules.type_fault(parameter, descriptor, declared=self.has_parameter(parameter.name)):
            return rules.refused(fault)
        if parameter.type_ is Parameter.Type.INTEGER and descriptor.integer_range:
            return self._apply_integer_range(parameter, descriptor.integer_range[0])
        if parameter.type_ is Parameter.Type.DOUBLE and descriptor.floating_point_range:
            return self._apply_floating_point_range(parameter, descriptor.floating_point_range[0])
        return rules.accepted()

    def _apply_integer_range(self, parameter: Parameter, integer_range: IntegerRange) -> SetParametersResult:
        fault = rules.integer_range_fault(parameter, integer_range)
        return rules.refused(fault) if fault else rules.accepted()

    def _apply_floating_point_range(
        self, parameter: Parameter, floating_point_range: FloatingPointRange
    ) -> SetParametersResult:
        fault = rules.floating_point_range_fault(parameter, floating_point_range, self.PARAM_REL_TOL)
        return rules.refused(fault) if fault else rules.accepted()

    def _apply_descriptor_and_set(
        self,
        parameter: Parameter,
        descriptor: ParameterDescriptor | None = None,
        check_read_only: bool = True,
    ) -> SetParametersResult:
        result = self._apply_descriptor(parameter, descriptor, check_read_only)
        if result.successful:
            self._parameters[parameter.name] = parameter
        return result

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


def _check_strings(names: list[str]) -> None:
    if not all(isinstance(name, str) for name in names):
        raise TypeError("All names must be instances of type str")


def _is_listed(name: str, prefixes: list[str], depth: int) -> bool:
    """Whether a name is one of the prefixes or lies below one, and not too deep below.

    Depth 0 is no limit.
    """

    def is_shallow(rest: str) -> bool:
        return depth == 0 or rest.count(PARAMETER_SEPARATOR_STRING) < depth

    if not prefixes:
        return is_shallow(name)
    return any(
        name == prefix
        or (name.startswith(prefix + PARAMETER_SEPARATOR_STRING) and is_shallow(name[len(prefix) + 1 :]))
        for prefix in prefixes
    )
