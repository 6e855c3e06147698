"""The parameters of a running node, through the services that it has for them."""

from __future__ import annotations

from collections.abc import Generator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

from ifgen.command_kit.tool import ToolError, did_you_mean
from ifgen_runtime.parameters.parameter_scalars import Value

if TYPE_CHECKING:
    from rcl_interfaces.msg import Parameter, ParameterDescriptor, ParameterValue, SetParametersResult
    from rclpy.parameter_client import AsyncParameterClient
    from rclpy.task import Future

    from ifgen_tools.session import Session

# Late imports: rclpy is found once the transport has been chosen.

TYPES: Final = {
    0: "not set",
    1: "boolean",
    2: "integer",
    3: "double",
    4: "string",
    5: "byte array",
    6: "boolean array",
    7: "integer array",
    8: "double array",
    9: "string array",
}
"""The names of rcl_interfaces/msg/ParameterType."""

FIELDS: Final = {
    1: "bool_value",
    2: "integer_value",
    3: "double_value",
    4: "string_value",
    5: "byte_array_value",
    6: "bool_array_value",
    7: "integer_array_value",
    8: "double_array_value",
    9: "string_array_value",
}
"""The fields of rcl_interfaces/msg/ParameterValue by its type."""

BYTES: Final = 5

_SERVICES_TAKE: Final = 5.0
"""Seconds that the services of a node may take to be discovered, as in ROS."""

_NO_VALUE: Final = "it is declared with a type only; set one, or give it one when the node starts"


@dataclass(frozen=True, slots=True)
class SetResult:
    """Whether a parameter has been set; if it has not, `reason` says why."""

    name: str
    successful: bool
    reason: str


def value_of(message: ParameterValue) -> Value | bytes:
    """The value in a rcl_interfaces/msg/ParameterValue; None if it is not set."""
    if message.type not in FIELDS:
        return None
    value: Any = getattr(message, FIELDS[message.type])
    if message.type == BYTES:
        return b"".join(value)
    return list(value) if message.type > BYTES else value


def json_value(message: ParameterValue) -> Any:
    """The value as JSON has it: bytes are a list of int."""
    value = value_of(message)
    return list(value) if isinstance(value, bytes) else value


@contextmanager
def remote_parameters(
    session: Session, node: str, patience: float | None = None, services_take: float | None = None
) -> Generator[RemoteParameters]:
    """The parameters of the node with this full name, until the block ends.

    `patience` is the time [s] that an answer may take; None is for ever. The services of the node may take
    `services_take` [s] to be discovered. Raises ToolError if they are not there.
    """
    from rclpy.parameter_client import AsyncParameterClient

    earlier = set(session.node.clients)
    client = AsyncParameterClient(session.node, node)
    try:
        limit = _SERVICES_TAKE if services_take is None else services_take
        if not session.wait_for(client.services_are_ready, limit):
            raise ToolError(
                f"the node {node!r} has no services for its parameters",
                "it was made with start_parameter_services=False, or it has just ended",
            )
        yield RemoteParameters(session, node, client, patience)
    finally:
        for each in set(session.node.clients) - earlier:  # rclpy's client has no `destroy`
            session.node.destroy_client(each)


class RemoteParameters:
    """The parameters of a node; `node` is its full name. Each method raises ToolError without an answer."""

    def __init__(
        self, session: Session, node: str, client: AsyncParameterClient, patience: float | None
    ) -> None:
        self.node = node
        self._session = session
        self._client = client
        self._patience = patience

    def names(self, prefixes: Sequence[str] = ()) -> list[str]:
        """The names of its parameters, or of those below the prefixes, sorted."""
        response = self._answer(self._client.list_parameters(list(prefixes)), "list_parameters")
        return sorted(response.result.names)

    def values(self, names: Sequence[str]) -> dict[str, ParameterValue]:
        """The values of parameters. Those that are not declared or have no value are missing."""
        found = self._values(names) if names else []
        if len(found) == len(names):
            return dict(zip(names, found, strict=True))
        # One that has no value is enough for an answer without any.
        each = {name: self._values([name]) for name in names}
        return {name: values[0] for name, values in each.items() if values}

    def descriptors(self, names: Sequence[str]) -> list[ParameterDescriptor]:
        """The descriptors of parameters; empty if one of them is not declared."""
        if not names:
            return []  # not a question about all
        response = self._answer(self._client.describe_parameters(list(names)), "describe_parameters")
        return list(response.descriptors)

    def known_descriptors(self, names: Sequence[str]) -> dict[str, ParameterDescriptor]:
        """The descriptors of those parameters that are declared, by name."""
        known = set(self.names())
        return {each.name: each for each in self.descriptors([name for name in names if name in known])}

    def types(self, names: Sequence[str]) -> dict[str, int]:
        """The declared types of parameters, of those without a value, too; empty if one is not declared."""
        return {descriptor.name: descriptor.type for descriptor in self.descriptors(names)}

    def all(self) -> list[tuple[ParameterDescriptor, ParameterValue | None]]:
        """The descriptors and values of all parameters, sorted by name; None for one without a value."""
        names = self.names()
        values, descriptors = self.values(names), self.descriptors(names)
        if len(descriptors) != len(names):
            raise ToolError(f"the parameters of {self.node!r} have changed meanwhile")
        return [(each, values.get(each.name)) for each in descriptors]

    def missing(self, name: str) -> ToolError:
        """The error for a parameter that has no value, or is not there."""
        known = self.names()
        if name in known:
            return ToolError(f"the parameter {name!r} of {self.node!r} has no value", _NO_VALUE)
        return ToolError(f"the node {self.node!r} has no parameter {name!r}", self.near(name, known))

    def near(self, name: str, known: list[str]) -> str:
        """Advice for a name that none of the parameters has."""
        return did_you_mean(name, known) or f"see `ifgen param list {self.node}`"

    def set(self, parameters: Sequence[Parameter]) -> list[SetResult]:
        """Set one parameter after the other."""
        if not parameters:
            return []
        response = self._answer(self._client.set_parameters(list(parameters)), "set_parameters")
        return [_result(*pair) for pair in zip(parameters, response.results, strict=True)]

    def set_atomically(self, parameters: Sequence[Parameter]) -> list[SetResult]:
        """Set all parameters or none."""
        future = self._client.set_parameters_atomically(list(parameters))
        result = self._answer(future, "set_parameters_atomically").result
        return [_result(parameter, result) for parameter in parameters]

    def _values(self, names: Sequence[str]) -> list[ParameterValue]:
        response = self._answer(self._client.get_parameters(list(names)), "get_parameters")
        return list(response.values)

    def _answer(self, future: Future[Any], service: str) -> Any:
        if not self._session.wait_for(future.done, self._patience):
            raise ToolError(
                f"the node {self.node!r} did not answer on {service!r} within {self._patience:g} s"
            )
        if (error := future.exception()) is not None:
            raise ToolError(f"the node {self.node!r} has not answered on {service!r}: {error}")
        return future.result()


def _result(parameter: Parameter, result: SetParametersResult) -> SetResult:
    return SetResult(parameter.name, result.successful, result.reason)
