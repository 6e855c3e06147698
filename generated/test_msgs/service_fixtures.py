"""Pairs of requests and responses, for tests of whatever carries them."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from test_msgs import message_fixtures
from test_msgs.srv import Arrays, BasicTypes, Empty


def _fields_of(message: Any) -> dict[str, Any]:
    return {name: getattr(message, name) for name in message.get_fields_and_field_types()}


def get_msg_empty() -> list[list[Any]]:
    """A request and a response with no fields."""
    return [[Empty.Request(), Empty.Response()]]


def get_msg_basic_types() -> list[list[Any]]:
    """Zeros asked and answered, and the greatest values answered by the least."""
    zeros, greatest, least, _ = map(_fields_of, message_fixtures.get_msg_basic_types())
    return [
        [
            BasicTypes.Request(**request, string_value="request"),
            BasicTypes.Response(**response, string_value="response"),
        ]
        for request, response in ((zeros, zeros), (greatest, least))
    ]


def get_msg_arrays() -> list[list[Any]]:
    """Full arrays asked, and answered by arrays in the opposite order."""
    asked = _fields_of(message_fixtures.get_msg_arrays()[0])
    del asked["alignment_check"]
    answered: dict[str, Any] = {
        name: values if name.endswith("_default") else list(values)[::-1] for name, values in asked.items()
    }
    return [[Arrays.Request(**asked), Arrays.Response(**answered)]]


_FIXTURES: dict[str, Callable[[], list[list[Any]]]] = {
    "Arrays": get_msg_arrays,
    "BasicTypes": get_msg_basic_types,
    "Empty": get_msg_empty,
}


def get_test_srv(service_name: str) -> list[list[Any]]:
    """The pairs of a type, by its name without the package; NotImplementedError for an unknown one."""
    if service_name not in _FIXTURES:
        raise NotImplementedError(f"there are no fixtures of a service '{service_name}'")
    return _FIXTURES[service_name]()
