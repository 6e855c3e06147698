"""The C extension under the sanitizers: its payload walker alone, and the whole of it inside real rclpy."""

from __future__ import annotations

import shutil
import subprocess
import sysconfig
from pathlib import Path

import pytest

from .support import PROGRAMS, ROOT, needs_rclpy, run_python

NATIVE = ROOT / "codegen" / "native"
SANITIZE = ["-std=c11", "-g", "-O1", "-fsanitize=address,undefined", "-fno-sanitize-recover=all"]

pytestmark = pytest.mark.skipif(shutil.which("gcc") is None, reason="needs gcc with its sanitizers")


def gcc(*arguments: str | Path) -> str:
    ran = subprocess.run(
        ["gcc", *map(str, arguments)], capture_output=True, text=True, timeout=60, check=False
    )
    assert ran.returncode == 0, ran.stderr
    return ran.stdout


def test_no_payload_makes_the_layout_walker_read_outside_it(tmp_path: Path) -> None:
    program = tmp_path / "layout_test"
    gcc(*SANITIZE, NATIVE / "tests" / "layout_test.c", NATIVE / "src" / "layout.c", "-o", program)
    ran = subprocess.run([str(program)], capture_output=True, text=True, timeout=60, check=False)
    assert ran.returncode == 0, ran.stderr
    assert ran.stdout.startswith("accepted ")


@pytest.fixture(scope="module")
def sanitized(tmp_path_factory: pytest.TempPathFactory) -> dict[str, str]:
    """The environment in which Python finds the extension built with the sanitizers."""
    folder = tmp_path_factory.mktemp("sanitized")
    package = folder / "ifgen_native"
    shutil.copytree(NATIVE / "ifgen_native", package, ignore=shutil.ignore_patterns("*.so"))
    include = f"-I{sysconfig.get_path('include')}"
    sources = sorted((NATIVE / "src").glob("*.c"))
    gcc(
        *SANITIZE,
        "-fPIC",
        "-shared",
        "-fvisibility=hidden",
        include,
        *sources,
        "-o",
        package / "_native.abi3.so",
    )
    libraries = [gcc(f"-print-file-name=lib{name}.so").strip() for name in ("asan", "ubsan")]
    environment = {
        "PYTHONPATH": str(folder),
        "LD_PRELOAD": ":".join(libraries),
        "PYTHONMALLOC": "malloc",  # or Python's own allocator hides what is freed
        "ASAN_OPTIONS": "detect_leaks=0",  # registrations are deliberately permanent; so is much of Python's memory
    }
    found = run_python(
        "-c",
        "from ifgen_native import _native; print(_native.__file__)",
        environment=environment,
    )
    assert found.stdout == f"{package / '_native.abi3.so'}\n", found.stderr
    return environment


@pytest.mark.slow
@needs_rclpy
@pytest.mark.parametrize("program", ["interfaces", "interop", "malformed", "refusals", "threads", "goals"])
def test_nothing_is_read_or_written_where_it_should_not_be(program: str, sanitized: dict[str, str]) -> None:
    ran = run_python(str(PROGRAMS / f"{program}.py"), environment=sanitized, limit=100)
    assert ran.returncode == 0, ran.stderr
    assert ran.stdout
    assert "AddressSanitizer" not in ran.stderr and "runtime error" not in ran.stderr, ran.stderr


@pytest.mark.slow
def test_the_sanitizers_are_on(sanitized: dict[str, str]) -> None:
    """They notice when a function reads beyond its memory."""
    ran = run_python("-c", CALL_WITH_TOO_LITTLE, environment=sanitized)
    assert ran.returncode != 0
    assert "AddressSanitizer: heap-buffer-overflow" in ran.stderr, ran.stderr


CALL_WITH_TOO_LITTLE = """
import ctypes
from ifgen_native import _native
capsules = _native.message("many::msg", "Small", 0, 0, 0, 0, bytes, bytes, b"")[1]
get_pointer = ctypes.pythonapi.PyCapsule_GetPointer
get_pointer.restype, get_pointer.argtypes = ctypes.c_void_p, [ctypes.py_object, ctypes.c_char_p]
to_python = ctypes.PYFUNCTYPE(ctypes.py_object, ctypes.c_void_p)(get_pointer(capsules[3], None))
malloc = ctypes.CDLL(None).malloc
malloc.restype = ctypes.c_void_p
to_python(malloc(8))
"""
