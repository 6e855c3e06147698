"""Describing a node's parameters, and holding their values to the descriptors."""

from __future__ import annotations

from rcl_interfaces.msg import (
    FloatingPointRange,
    IntegerRange,
    ParameterDescriptor,
    ParameterValue,
    SetParametersResult,
)
from rcl_interfaces.msg import Parameter as ParameterMsg

from rclpy._node import parameter_rules as rules
from rclpy._node.parameter_store import ParameterStore
from rclpy.exceptions import (
    InvalidParameterValueException,
    ParameterImmutableException,
    ParameterNotDeclaredException,
)
from rclpy.parameter import Parameter

Descriptors = dict[str, ParameterDescriptor]


class DescribedParameters(ParameterStore):
    """Parameters whose values have to obey descriptors."""

    PARAM_REL_TOL = rules.RELATIVE_TOLERANCE

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
