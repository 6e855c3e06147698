"""The C code that looks at payloads under a DDS lock, under the sanitizers."""

import shutil
import subprocess
from pathlib import Path

import pytest

NATIVE = Path(__file__).parents[2] / "codegen" / "native"


@pytest.mark.skipif(shutil.which("gcc") is None, reason="needs gcc with its sanitizers")
def test_no_payload_makes_the_layout_walker_read_outside_it(tmp_path: Path) -> None:
    program = tmp_path / "layout_test"
    sources = [NATIVE / "tests" / "layout_test.c", NATIVE / "src" / "layout.c"]
    flags = ["-std=c11", "-g", "-fsanitize=address,undefined", "-fno-sanitize-recover=all"]
    subprocess.run(["gcc", *flags, *map(str, sources), "-o", str(program)], check=True, timeout=60)
    ran = subprocess.run([str(program)], capture_output=True, text=True, timeout=60, check=False)
    assert ran.returncode == 0, ran.stderr
    assert ran.stdout.startswith("accepted ")
