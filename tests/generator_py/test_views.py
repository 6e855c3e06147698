"""The views of nodes that templates of outputs get."""

from __future__ import annotations

import pytest
import yaml
from ifgen.generator_py.outputs.nodes import node_model
from ifgen.nodl.model import NodeDescription, Parameter, ParameterType, ParameterValue


@pytest.mark.parametrize(
    ("type_", "value"),
    [
        (ParameterType("double"), 1e-05),
        (ParameterType("double"), float("inf")),
        (ParameterType("string"), 'a\tb\x07 "c"'),
        (ParameterType("int", array=True), (1, 2)),
    ],
)
def test_a_default_is_yaml_that_every_reader_takes(type_: ParameterType, value: ParameterValue) -> None:
    nothing = ((),) * 6
    parameters = (Parameter("gain", type_, value),)
    node = NodeDescription("robot", "arm", "", "callbacks", "Arm", "arm.py", parameters, *nothing)
    [parameter] = node_model(node).parameters
    assert parameter.default is not None
    loaded = yaml.safe_load(parameter.default)
    assert (tuple(loaded) if isinstance(value, tuple) else loaded) == value
