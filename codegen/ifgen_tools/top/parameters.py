"""The parameters of one node, read through the services that every node has."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

from ifgen_runtime.printable import printable

if TYPE_CHECKING:
    from ifgen_tools.session import Session

_PATIENCE: Final = 2.0  # [s]
_FIELDS: Final = (
    "",
    "bool_value",
    "integer_value",
    "double_value",
    "string_value",
    "byte_array_value",
    "bool_array_value",
    "integer_array_value",
    "double_array_value",
    "string_array_value",
)
"""The field of a ParameterValue by its `type`."""


@dataclass(frozen=True, slots=True)
class Parameters:
    """The parameters of a node as (name, value), or the reason why there are none."""

    node: str
    values: tuple[tuple[str, str], ...] = ()
    problem: str = ""


def read(session: Session, node: str) -> Parameters:
    """Ask a node for all of its parameters, and wait for the answers, but not long."""
    from rcl_interfaces.srv import GetParameters, ListParameters  # those of the chosen transport

    names = _asked(session, ListParameters, f"{node}/list_parameters", ListParameters.Request())
    if names is None:
        return Parameters(node, problem="it has no parameter services, or does not answer")
    request = GetParameters.Request(names=sorted(names.result.names))
    found = _asked(session, GetParameters, f"{node}/get_parameters", request)
    if found is None or len(found.values) != len(request.names):
        return Parameters(node, problem="it does not answer")
    values = zip(request.names, map(shown, found.values), strict=True)
    return Parameters(node, tuple((printable(name), value) for name, value in values))


def shown(value: Any) -> str:
    """The value of a ParameterValue for people."""
    if not 0 < value.type < len(_FIELDS):
        return "not set"
    found = getattr(value, _FIELDS[value.type])
    if isinstance(found, str):
        return printable(found)
    if isinstance(found, bool | int | float):
        return str(found).lower() if isinstance(found, bool) else str(found)
    values = [each[0] if isinstance(each, bytes) else each for each in found]
    return printable(str(values))


def _asked(session: Session, kind: type[Any], name: str, request: Any) -> Any:
    client = session.node.create_client(kind, name)
    try:
        if not session.wait_for(client.service_is_ready, _PATIENCE):
            return None
        future = client.call_async(request)
        if not session.wait_for(future.done, _PATIENCE) or future.exception() is not None:
            return None
        return future.result()
    finally:
        session.node.destroy_client(client)
