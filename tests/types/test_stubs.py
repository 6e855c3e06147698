"""Stubs: what of a module they show, and that those of rclpy are whole."""

from __future__ import annotations

import ast
import os
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path

import pytest
from ifgen.generator_py.stubs import of_rclpy, stub_of

ROOT = Path(__file__).parent.parent.parent


@pytest.fixture(scope="module")
def rclpy() -> Mapping[str, str]:
    """The stubs of rclpy, by their paths."""
    return of_rclpy(ROOT / "codegen" / "underlay")


def text_of(source: str) -> str:
    return ast.unparse(ast.fix_missing_locations(stub_of(source, hidden="secret")))


@pytest.mark.parametrize(
    ("source", "stub"),
    [
        (
            "def f(a: int = 3, b: str = g()) -> int:\n    'Says.'\n    return 1",
            'def f(a: int=3, b: str=...) -> int:\n    """Says."""\n    ...',
        ),
        ("def _f() -> int: ...", ""),
        ("def _f() -> int: ...\nx = _f()", "def _f() -> int:\n    ...\nx = _f()"),
        ("import a, b\nx: b.C", "import b\nx: b.C"),
        ("import b\nx: 'b'", "import b\nx: 'b'"),
        ("from a import b as b, c", "from a import b as b"),
        ("from a import b, c\n__all__ = ['b']", "from a import b\n__all__ = ['b']"),
        ("from secret import S\nx: S", "from typing import Any\nS = Any\nx: S"),
        ("if TYPE_CHECKING:\n    x: int\nelse:\n    x = y()", "x: int"),
        ("if not TYPE_CHECKING:\n    def __getattr__(n): ...", ""),
        ("for x in y():\n    print(x)", ""),
        (
            "@overload\ndef f(a: int) -> int: ...\n@overload\ndef f(a: str) -> str: ...\ndef f(a): return a",
            "@overload\ndef f(a: int) -> int:\n    ...\n\n@overload\ndef f(a: str) -> str:\n    ...",
        ),
        (
            "class C(B[int]):\n    'A class.'\n    x = 1\n    def __init__(self, a: int) -> None:\n        self.a = a\n        self._b = a\n        self.c = C(1)\n        self.d: list[int] = []\n        self.e = a + 1\n    def _g(self): ...",
            'from typing import Any\n\nclass C(B[int]):\n    """A class."""\n    x = 1\n    a: int\n    c: C\n    d: list[int]\n    e: Any\n\n    def __init__(self, a: int) -> None:\n        ...',
        ),
        (
            "class C:\n    @property\n    @logged\n    def x(self) -> int: return 1",
            "class C:\n\n    @property\n    def x(self) -> int:\n        ...",
        ),
        ("class C:\n    __hash__ = None", "class C:\n    ..."),
    ],
)
def test_what_a_stub_shows(source: str, stub: str) -> None:
    assert text_of(source) == stub


def test_no_module_accepts_any_name(rclpy: Mapping[str, str]) -> None:
    assert not [name for name, text in rclpy.items() if "def __getattr__" in text]


def test_the_stubs_of_rclpy_need_no_other_package_of_ours(rclpy: Mapping[str, str]) -> None:
    assert len(rclpy) > 60
    assert not [name for name, text in rclpy.items() if "rmw_local" in text]


def test_the_attributes_of_public_classes_have_types(rclpy: Mapping[str, str]) -> None:
    """An attribute whose type nobody wrote, and that cannot be told, is Any in the stubs alone."""
    untold = [
        f"{name}: {line.strip()}"
        for name, text in rclpy.items()
        if not name.startswith(("impl/", "_"))
        for line in text.splitlines()
        if line.startswith("    ") and line.endswith(": Any")
    ]
    assert untold == []


@pytest.mark.slow
def test_the_stubs_themselves_satisfy_mypy(rclpy: Mapping[str, str], tmp_path: Path) -> None:
    for name, text in rclpy.items():
        path = tmp_path / "rclpy" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    folders = (ROOT / "codegen", ROOT / "generated", ROOT / "codegen/libraries")
    ended = subprocess.run(
        [sys.executable, "-m", "mypy", "--strict", "--config-file=", f"--cache-dir={tmp_path}", "rclpy"],
        cwd=tmp_path,
        env={**os.environ, "MYPYPATH": os.pathsep.join(map(str, folders))},
        capture_output=True,
        text=True,
        timeout=240,
        check=False,
    )
    assert ended.returncode == 0, ended.stdout + ended.stderr
