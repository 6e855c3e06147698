"""The hashes of requests and responses of services in other processes, which announce those of services only."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest
from example_interfaces.action import Fibonacci
from rclpy.impl.rcl.graph import _part  # pyright: ignore[reportPrivateUsage] - no other process is needed
from rmw_local.message import service_with_hash
from rmw_local.transports.remote import RemoteServiceType
from std_srvs.srv import SetBool


@pytest.mark.parametrize(
    ("name", "cls"),
    [
        ("std_srvs/srv/SetBool", SetBool),
        ("example_interfaces/action/Fibonacci_SendGoal", Fibonacci.Impl.SendGoalService),
        ("example_interfaces/action/Fibonacci_GetResult", Fibonacci.Impl.GetResultService),
    ],
)
def test_parts_have_the_hashes_of_a_definition_that_is_here(name: str, cls: Any) -> None:
    kind = RemoteServiceType(name, cls.__type_hash__)
    endpoint: Any = SimpleNamespace(service_type=kind)
    assert _part(endpoint, kind.request).type_hash == cls.Request.__type_hash__
    assert _part(endpoint, kind.response).type_hash == cls.Response.__type_hash__


@pytest.mark.parametrize(
    "name", ["std_srvs/srv/SetBool", "std_srvs/srv/None", "nowhere/srv/Set", "std_srvs/action/A_SendGoal"]
)
def test_parts_of_another_definition_stay_unknown(name: str) -> None:
    kind = RemoteServiceType(name, "RIHS01_" + "a" * 64)
    endpoint: Any = SimpleNamespace(service_type=kind)
    assert service_with_hash(name, kind.type_hash) is None
    assert _part(endpoint, kind.request).type_hash == ""
