"""Large sequences on real rclpy, whose memory serves again: in a process of their own."""

from __future__ import annotations

import os

import ifgen
import pytest

from .support import PROGRAMS, ROOT, needs_rclpy, run_python
from .test_real_rclpy import RCLPY_ABORT

pytestmark = needs_rclpy

BASIC_TYPES = ["int8", "uint8", "int16", "uint16", "int32", "uint32", "int64", "uint64", "float32", "float64"]


@pytest.fixture(scope="module")
def path(tmp_path_factory: pytest.TempPathFactory) -> str:
    """Where large_msgs is, a package with sequences of each type."""
    folder = tmp_path_factory.mktemp("large")
    messages = folder / "in" / "large_msgs" / "msg"
    messages.mkdir(parents=True)
    for name in BASIC_TYPES:
        text = f"string head\nuint8 before\n{name}[] values\nfloat64 after\nstring tail\n"
        (messages / f"Of{name.capitalize()}.msg").write_text(text)
    (messages / "Pair.msg").write_text("OfUint8 left\nOfUint16 right\n")
    fields = "".join(f"uint8[] values_{number}\nfloat64 after_{number}\n" for number in range(10))
    (messages / "Many.msg").write_text(f"{fields}string tail\n")
    ifgen.generate(folder / "in", output=folder / "out")
    return os.pathsep.join((str(folder / "out"), str(ROOT / "codegen")))


@pytest.fixture(params=["native", pytest.param("python", marks=pytest.mark.slow)])
def environment(path: str, request: pytest.FixtureRequest) -> dict[str, str]:
    return {"PYTHONPATH": path, "IFGEN_CODEC": request.param}


def test_large_sequences_are_whole_and_nobody_elses(environment: dict[str, str]) -> None:
    ran = run_python(str(PROGRAMS / "large.py"), environment=environment, limit=100)
    assert ran.returncode == 0, ran.stderr
    assert ran.stdout.splitlines() == [
        "types []",
        "again True",
        "kept True 8",
        "views True True",
        *["changed True True"] * 3,
        *["nested True"] * 4,
        "broken 3 True",
        "threads []",
        "waiting [6, 7]",  # 48 MiB of 64
        "publishes True",
    ]


def test_large_arrays_are_sent_from_where_they_are(environment: dict[str, str]) -> None:
    ran = run_python(str(PROGRAMS / "sending.py"), environment=environment, limit=100)
    assert ran.returncode in (0, RCLPY_ABORT[0]) and ran.stderr in ("", RCLPY_ABORT[1]), ran.stderr
    in_c = environment["IFGEN_CODEC"] == "native"
    # What Python encodes is a copy, and holds nothing.
    held = "held" if in_c else "free"
    assert ran.stdout.splitlines() == [
        f"codec {'C' if in_c else 'Python'}",
        f"held True {held} True free free",
        "bytes []",
        "error Image.step: expected an integer in [0, 4294967295], got -1 free",
        "goes on True",
        "torn 0 []",
        "contexts [[0, 1, 2], [10, 11, 12, 13, 14]]",
        "leaving",
    ]
