"""A service in two versions, its servers, and adapters between the versions."""

from __future__ import annotations

from typing import Any

from ifgen.dynamic import class_from_text
from ifgen_runtime.adapters import Adapter, register

ADD = "demo_msgs/srv/Add"
OldAdd = class_from_text(ADD, "float32 a\n---\nfloat32 sum")
NewAdd = class_from_text(ADD, "float64 a\nfloat64 b\n---\nfloat64 sum\nstring note")
Message = Any


def adapters_for_add(within: str = "") -> None:
    """Register them; those of `ifgen adapt --downgrade` hold within the old service only."""
    register(
        Adapter(
            OldAdd.Request,
            NewAdd.Request,
            lambda m: NewAdd.Request(a=m.a, b=0.1),
            lambda m: OldAdd.Request(a=m.a),
            within=within,
        )
    )
    register(
        Adapter(
            OldAdd.Response,
            NewAdd.Response,
            lambda m: NewAdd.Response(sum=m.sum, note="adapted"),
            lambda m: OldAdd.Response(sum=m.sum),
            within=within,
        )
    )


def new_add(request: Message, response: Message) -> Message:
    """Answer as the new version."""
    assert type(request) is NewAdd.Request
    response.sum = request.a + request.b
    return response


def old_add(request: Message, response: Message) -> Message:
    """Answer as the old version."""
    assert type(request) is OldAdd.Request
    response.sum = request.a * 2
    return response
