"""Generated classes for the tests, separate from a ROS that may be installed."""

from __future__ import annotations

import importlib
import os
import pkgutil
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import ifgen
import pytest

ROOT = Path(__file__).resolve().parents[2]
OWN_INTERFACES = Path(__file__).with_name("codec_msgs")


class Classes(dict[str, type[Any]]):
    """Message classes by type name, parts of services and actions included."""

    def __repr__(self) -> str:
        return "classes"


def folder_of_all(factory: pytest.TempPathFactory) -> Path:
    """A folder that all processes of this run share: what one of them generates, the others find up to date."""
    own = factory.getbasetemp()
    return (own.parent if "PYTEST_XDIST_WORKER" in os.environ else own) / "codec"


def generate(output: Path, *paths: Path) -> Classes:
    """The classes of the interfaces at some paths, generated now; by default the bundled ones and codec_msgs."""
    ifgen.generate(*(paths or (ROOT / "interfaces", OWN_INTERFACES)), output=output, with_deps=True)
    packages = sorted(path.name for path in output.iterdir() if (path / "__init__.py").is_file())
    with _apart(packages, output):
        for package in packages:
            module = importlib.import_module(package)
            for info in pkgutil.walk_packages(module.__path__, f"{package}."):
                importlib.import_module(info.name)
        modules = [module for name, module in sys.modules.items() if name.partition(".")[0] in packages]
    values = [value for module in modules for value in vars(module).values()]
    found = [value for value in values if isinstance(value, type) and "__codec__" in vars(value)]
    return Classes({"/".join([*cls.__module__.split(".")[:2], cls.__name__]): cls for cls in found})


@contextmanager
def _apart(packages: list[str], folder: Path) -> Iterator[None]:
    """Import these packages from this folder, and leave no trace of it."""

    def ours() -> list[str]:
        return [name for name in sys.modules if name.partition(".")[0] in packages]

    before = {name: sys.modules.pop(name) for name in ours()}
    sys.path.insert(0, str(folder))
    try:
        yield
    finally:
        sys.path.remove(str(folder))
        for name in ours():
            del sys.modules[name]
        sys.modules.update(before)
        importlib.invalidate_caches()


@contextmanager
def without_slow_path(cls: type[Any]) -> Iterator[None]:
    """Make the generated functions of the class raise SlowPathTaken where they would start over."""
    names = vars(cls)["__codec__"][0].__globals__
    saved = {name: names[name] for name in ("encode_any", "decode_any")}

    def refuse(*arguments: Any) -> None:
        raise SlowPathTaken(arguments)

    names.update(dict.fromkeys(saved, refuse))
    try:
        yield
    finally:
        names.update(saved)


class SlowPathTaken(BaseException):
    """A generated function gave up. It is not an Exception, so that nothing catches it on the way."""
