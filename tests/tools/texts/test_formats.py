"""Messages as YAML, CSV and JSON: the texts that `ros2 topic echo` prints."""

from __future__ import annotations

import csv
import io
import json
import math
from typing import Any

import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st
from ifgen.dynamic import class_from_text
from ifgen_tools.texts import formats
from ifgen_tools.texts.formats import Style, as_csv, as_json, as_yaml
from sensor_msgs.msg import JointState

DEFINITION = """\
std_msgs/Header header
float64[2] pair
float32[] ranges
string[<=3] names
string<=8 text "a b"
std_msgs/Empty nothing
geometry_msgs/Point[] points
byte[] blob
bool on
"""
# What ros2 of Jazzy prints for it on the real rclpy.
BLOCK = """\
header:
  stamp:
    sec: 1
    nanosec: 0
  frame_id: map
pair:
- 0.1
- 1.0e-07
ranges: []
names:
- a
- ''
text: a b
nothing: {}
points:
- x: 0.1
  y: 0.0
  z: 0.0
- x: 0.0
  y: 0.0
  z: .nan
blob:
- "\\x05"
'on': true
"""
CUT = """\
header:
  stamp:
    sec: 1
    nanosec: 0
  frame_id: m...
pair: [0.1, '...']
ranges: []
names: [a, '...']
text: a...
nothing: {}
points: [{x: 0.1, y: 0.0, z: 0.0}, '...']
blob: ["\\x05"]
'on': true
"""


@pytest.fixture(scope="module")
def message() -> Any:
    cls = class_from_text("demo_msgs/msg/Odd", DEFINITION)
    message = cls(pair=[0.1, 1e-7], names=["a", ""], blob=[b"\x05"], on=True)
    message.header.frame_id = "map"
    message.header.stamp.sec = 1
    point = type(class_from_text("demo_msgs/msg/P", "geometry_msgs/Point p")().p)
    message.points = [point(x=0.1), point(z=math.nan)]
    return message


def test_block_style(message: Any) -> None:
    assert as_yaml(message) == BLOCK


def test_flow_style_and_cut(message: Any) -> None:
    lines = as_yaml(message, Style(longest=1, flow=True))
    assert lines == CUT


def test_without_arrays_and_strings(message: Any) -> None:
    found = yaml.safe_load(as_yaml(message, Style(no_arr=True, no_str=True)))
    assert found["header"]["frame_id"] == "<string length: <3>>"
    assert found["pair"] == "<array type: double[2]>"
    assert found["ranges"] == "<sequence type: float, length: 0>"
    assert found["names"] == "<sequence type: string[3], length: 2>"
    assert found["points"] == "<sequence type: geometry_msgs/msg/Point, length: 2>"


def test_csv_in_quotes() -> None:
    """As spreadsheets, pandas and Python's csv read it again."""
    texts = ["a,b", 'say "a"', "two\nlines", "plain", " x", ""]
    message = JointState(name=texts, position=[0.1])
    [row] = csv.reader(io.StringIO(as_csv(message, Style())))
    assert row[3:10] == [*texts, "0.1"]
    assert (
        as_csv(JointState(name=["a"]), Style(no_arr=True)).count('"<sequence type: string, length: 1>"') == 1
    )


def test_csv(message: Any) -> None:
    values = ["1,0,map", "0.1,1e-07", "", "a,", "a b", "", "0.1,0.0,0.0,0.0,0.0,nan", "b'\\x05'", "True"]
    assert as_csv(message, Style()) == ",".join(values)
    assert as_csv(message, Style(longest=1)).startswith("1,0,m...,0.1,...,,a,...,a...,")


def test_json(message: Any) -> None:
    found = json.loads(as_json(message, {"source_timestamp": 7}))
    assert found["info"] == {"source_timestamp": 7}
    assert found["message"]["points"][1]["z"] == "NaN"
    assert found["message"]["pair"] == [0.1, 1e-7]


TEXTS = st.text(st.sampled_from("abyesnoftrul0123 .:#'\"/-_~\n\té…"), max_size=7)


@given(
    st.dictionaries(
        TEXTS.filter(str.isidentifier), TEXTS | st.floats() | st.integers() | st.booleans(), min_size=1
    )
)
def test_the_fast_way_writes_what_pyyaml_writes(document: dict[str, Any]) -> None:
    try:
        lines = formats._lines(document, "")
    except formats._Hard:
        return
    slowly = yaml.dump(document, Dumper=formats._Dumper, allow_unicode=True, default_flow_style=False)
    assert "\n".join(lines) + "\n" == slowly
