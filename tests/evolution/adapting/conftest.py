"""A project with two versions of its interfaces, for tests of adapters."""

from __future__ import annotations

import importlib
import sys
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from types import ModuleType
from typing import Any

import ifgen as toolkit
import pytest
from ifgen_runtime import adapters

from tests.cli import conftest as command_line
from tests.cli.conftest import Run, write
from tests.runtime.support import imported_from

ROOT = Path(__file__).resolve().parents[3]

cache_folder, clean_environment = command_line.cache_folder, command_line.clean_environment
git, ifgen = command_line.git, command_line.ifgen

Adapt = Callable[..., Any]


@pytest.fixture
def project(tmp_path: Path) -> Callable[[Mapping[str, str], Mapping[str, str]], None]:
    """`project(old, new)` writes both versions of `robot_msgs`: texts of files by their paths in it."""

    def make(old: Mapping[str, str], new: Mapping[str, str]) -> None:
        for folder, files in (("old", old), ("interfaces", new)):
            for path, text in files.items():
                write(tmp_path / folder / "robot_msgs" / path, text)
        write(tmp_path / "pyproject.toml", '[tool.ifgen]\npaths = ["interfaces"]\n')

    return make


@pytest.fixture
def adapt(
    project: Any,
    ifgen: Run,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> Iterator[Adapt]:
    """`adapt(old, new, "msg/Speed")` writes the adapter of a type and imports it; or those of several types."""
    monkeypatch.setattr(adapters, "_registered", {})
    monkeypatch.setattr(adapters, "_found", {})
    packages = ("adapters", "robot_msgs", *(path.name for path in (ROOT / "generated").iterdir()))

    def make(old: Mapping[str, str], new: Mapping[str, str], names: str | list[str], *options: str) -> Any:
        project(old, new)
        toolkit.generate(tmp_path / "interfaces", output=tmp_path / "generated")
        found: list[ModuleType] = []
        for name in [names] if isinstance(names, str) else names:
            done = ifgen("adapt", f"robot_msgs/{name}", "--from", "old", *options)
            assert done.code == 0, done.err
            [path] = Path("adapters").glob(f"{name.partition('/')[2].lower()}_*.py")
            importlib.invalidate_caches()
            found.append(importlib.import_module(f"adapters.{path.stem}"))
        return found[0] if isinstance(names, str) else found

    with imported_from(ROOT / "generated", packages):
        sys.path[:0] = [str(tmp_path), str(tmp_path / "generated")]
        try:
            yield make
        finally:
            del sys.path[:2]
