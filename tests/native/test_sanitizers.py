"""The C extension under the sanitizers: its payload walker alone, and the whole of it inside real rclpy."""

from __future__ import annotations

import subprocess
import zlib
from pathlib import Path

import pytest

from . import sanitizers
from .sanitizers import NATIVE, SANITIZE, SIGNS, gcc
from .support import PROGRAMS, needs_rclpy, run_python

pytestmark = pytest.mark.skipif(bool(sanitizers.why_not()), reason=sanitizers.why_not())


def test_no_payload_makes_the_layout_walker_read_outside_it(tmp_path: Path) -> None:
    program = tmp_path / "layout_test"
    gcc(
        *SANITIZE,
        NATIVE / "tests" / "layout_test.c",
        NATIVE / "src" / "layout.c",
        NATIVE / "src" / "table.c",
        "-o",
        program,
    )
    ran = subprocess.run([str(program)], capture_output=True, text=True, timeout=60, check=False)
    assert ran.returncode == 0, ran.stderr
    assert ran.stdout.startswith("accepted ")


@pytest.fixture(scope="module")
def sanitized(tmp_path_factory: pytest.TempPathFactory) -> dict[str, str]:
    """The environment in which Python finds the extension built with the sanitizers."""
    environment = sanitizers.build(tmp_path_factory.mktemp("sanitized"))
    found = run_python(
        "-c",
        "from ifgen_native import _native; print(_native.__file__)",
        environment=environment,
    )
    assert found.stdout.startswith(environment["PYTHONPATH"]), found.stderr
    return environment


@pytest.mark.slow
@needs_rclpy
@pytest.mark.parametrize("program", ["interfaces", "interop", "malformed", "refusals", "threads", "goals"])
def test_nothing_is_read_or_written_where_it_should_not_be(program: str, sanitized: dict[str, str]) -> None:
    ran = run_python(str(PROGRAMS / f"{program}.py"), environment=sanitized, limit=100)
    assert ran.returncode == 0, ran.stderr
    assert ran.stdout
    assert not any(sign in ran.stderr for sign in SIGNS), ran.stderr


@pytest.mark.slow
def test_checksums_read_what_they_are_given(sanitized: dict[str, str]) -> None:
    program = "from ifgen_native._native import crc32\nfor n in range(300): crc32(bytearray(n))\nprint(crc32(bytearray(10**6)))"
    ran = run_python("-c", program, environment=sanitized)
    assert ran.stdout == f"{zlib.crc32(bytes(10**6))}\n", ran.stderr
    assert not any(sign in ran.stderr for sign in SIGNS), ran.stderr


@pytest.mark.slow
def test_the_sanitizers_are_on(sanitized: dict[str, str]) -> None:
    """They notice when a function reads beyond its memory."""
    ran = run_python("-c", CALL_WITH_TOO_LITTLE, environment=sanitized)
    assert ran.returncode != 0
    assert "AddressSanitizer: heap-buffer-overflow" in ran.stderr, ran.stderr


CALL_WITH_TOO_LITTLE = """
import ctypes
from ifgen_native import _native
capsules = _native.message(object, "many::msg", "Small", 0, 0, 0, 0, bytes, bytes, (("R1 Z", b""),))[1]
get_pointer = ctypes.pythonapi.PyCapsule_GetPointer
get_pointer.restype, get_pointer.argtypes = ctypes.c_void_p, [ctypes.py_object, ctypes.c_char_p]
to_python = ctypes.PYFUNCTYPE(ctypes.py_object, ctypes.c_void_p)(get_pointer(capsules[3], None))
malloc = ctypes.CDLL(None).malloc
malloc.restype = ctypes.c_void_p
to_python(malloc(8))
"""
