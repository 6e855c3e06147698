"""The definition in what another node answers."""

from __future__ import annotations

from types import SimpleNamespace

import ifgen.dynamic
import pytest
from ifgen_runtime import from_dict
from ifgen_runtime.mismatch.sides import definition_from, definition_of
from type_description_interfaces.msg import TypeSource
from type_description_interfaces.srv import GetTypeDescription


def test_an_answer_has_the_definition_that_the_class_of_the_other_node_was_generated_from() -> None:
    text = "geometry_msgs/Point[<=3] path\nfloat64 speed 0.1  # [m/s]\n"
    own = definition_of(ifgen.dynamic.class_from_text("robot_msgs/msg/Plan", text))
    response = GetTypeDescription.Response(successful=True)
    response.type_description = from_dict(type(response.type_description), own.document)
    response.type_sources = [
        TypeSource(type_name=name, encoding=encoding, raw_file_contents=text)
        for name, encoding, text in own.sources
    ]
    found = definition_from(response)
    assert found == own
    assert found.sources[0] == ("robot_msgs/msg/Plan", "msg", text)


@pytest.mark.parametrize(
    ("reason", "said"), [("no such type", "no such type"), ("", "the node does not say why")]
)
def test_a_node_that_refuses_says_why(reason: str, said: str) -> None:
    with pytest.raises(ValueError, match=f"^{said}$"):
        definition_from(SimpleNamespace(successful=False, failure_reason=reason))
