"""The libraries where numpy is missing."""

from __future__ import annotations

import subprocess
import sys

import pytest


@pytest.mark.parametrize("module", ["point_cloud2", "numpy_compat"])
def test_one_clear_error(module: str) -> None:
    program = f"""
import sys, ifgen
sys.modules["numpy"] = None
ifgen.activate("local")
import sensor_msgs_py
try:
    import sensor_msgs_py.{module}
except ImportError as error:
    print(f"{{type(error).__name__}} {{error.name}}: {{error}}")
    assert error.__cause__ is error.__context__ is None
"""
    said = subprocess.check_output([sys.executable, "-c", program], text=True, timeout=60)
    assert said == (
        "ModuleNotFoundError numpy: sensor_msgs_py needs numpy: run `python -m pip install numpy`\n"
    )


def test_tf2_does_without() -> None:
    program = """
import sys, ifgen
sys.modules["numpy"] = None
ifgen.activate("local")
import tf2_ros, tf2_geometry_msgs
buffer = tf2_ros.Buffer()
transform = tf2_ros.TransformStamped(child_frame_id="base")
transform.header.frame_id = "map"
transform.transform.translation.x = 0.1
buffer.set_transform(transform, "test")
pose = tf2_ros.PoseStamped()
pose.header.frame_id = "base"
print(buffer.transform(pose, "map").pose.position.x)
"""
    assert subprocess.check_output([sys.executable, "-c", program], text=True, timeout=60) == "0.1\n"
