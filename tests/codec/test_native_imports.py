"""What is loaded when: the extension and numpy only with the first message that needs them."""

from __future__ import annotations

import os
import subprocess
import sys
import textwrap
from pathlib import Path

import pytest
from ifgen_runtime.codec.choice import chosen

ROOT = Path(__file__).resolve().parents[2]
needs_native = pytest.mark.skipif(chosen().extension is None, reason=f"no codec in C: {chosen().reason}")


def run(program: str) -> str:
    """What a program prints, in a process of its own."""
    paths = os.pathsep.join([str(ROOT / "generated"), str(ROOT / "codegen")])
    ran = subprocess.run(
        [sys.executable, "-c", textwrap.dedent(program)],
        env={**os.environ, "PYTHONPATH": paths},
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    assert ran.returncode == 0, ran.stderr
    return ran.stdout.strip()


def test_importing_a_message_package_loads_no_extension_and_no_numpy() -> None:
    output = run("""
        import sys
        from geometry_msgs.msg import Twist
        from sensor_msgs.msg import Imu
        print(sorted({"ifgen_native", "ifgen_runtime.codec.choice", "numpy"} & sys.modules.keys()))
        Twist().__serialize__()
        print("numpy" in sys.modules)
    """)
    assert output.split("\n") == ["[]", "False"]


@needs_native
def test_numpy_is_loaded_with_the_first_array() -> None:
    """Not with the first message of a class that could have one. C then starts that message again."""
    output = run("""
        import sys
        from ifgen_native._native import codec_counts
        from ifgen_runtime import deserialize, serialize
        from sensor_msgs.msg import Imu
        from test_msgs.msg import UnboundedSequences
        serialize(UnboundedSequences())
        print("numpy" in sys.modules)
        deserialize(bytes([0, 1, 0, 0]) + bytes(8) + bytes([1, 0, 0, 0]) + bytes(308), Imu)
        print("numpy" in sys.modules, codec_counts())
    """)
    assert output.split("\n") == ["False", "True (1, 1, 0)"]


def test_modules_of_an_older_ifgen_keep_working() -> None:
    """They attach two functions, and no table."""
    output = run("""
        import ifgen_runtime.codec as codec
        attach = codec.attach_codec
        codec.attach_codec = lambda *arguments, table: attach(*arguments)
        from geometry_msgs.msg import Twist
        data = codec.serialize(Twist())
        assert codec.deserialize(data, Twist) == Twist.__deserialize__(data) == Twist()
        print(len(data), "__codec__" in vars(Twist))
    """)
    assert output == "52 False"
