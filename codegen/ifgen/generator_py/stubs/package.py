"""The files of the stubs of a package."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Mapping
from pathlib import Path

from ifgen.generator_py.stubs import derive

# Enumerations get their members elsewhere, which mypy minds in stubs and nowhere else. Messages with views
# have fields of other types than their base.
_HEADER = (
    "# Stub by `ifgen typings`: do not edit.\n"
    '# mypy: disable-error-code="misc, assignment"\n'
    "# pyright: reportIncompatibleVariableOverride=false, reportAssignmentType=false\n"
)
# The part that upstream has, too. The rest of rclpy.impl is ours, and is written as far as the others need
# it.
_UPSTREAMS = {
    "rclpy.impl.implementation_singleton",
    "rclpy.impl.logging_severity",
    "rclpy.impl.rcutils_logger",
}
_CODECS = "\n# The codecs: "  # no types from here on, in generated modules


def of_rclpy(underlay: Path) -> Mapping[str, str]:
    """The stubs of rclpy, by path in its folder: of all that programs import, and of what that needs."""
    sources = _modules(underlay / "rclpy", "rclpy")
    waiting = [name for name in sources if _is_public(name)]
    stubs: dict[str, ast.Module] = {}
    while waiting:
        name = waiting.pop()
        if name in stubs:
            continue
        path = sources[name]
        stubs[name] = stub = derive.stub(path.read_text(encoding="utf-8"), hidden="rmw_local")
        inside = f"{name}.__init__" if path.stem == "__init__" else name
        waiting += [
            home for each in derive.imported(stub, inside) for home in _homes(each) if home in sources
        ]
    return {
        _stub_path(sources[name], underlay / "rclpy"): _text(stub) for name, stub in sorted(stubs.items())
    }


def of_messages(folder: Path) -> Mapping[str, str]:
    """The stubs of a generated package of interfaces, by path in its folder; its tests have none."""
    return {
        _stub_path(path, folder): _text(derive.stub(path.read_text(encoding="utf-8").partition(_CODECS)[0]))
        for name, path in _modules(folder, folder.name).items()
        if name.split(".")[1:2] != ["test"]
    }


def of_library(folder: Path) -> Mapping[str, str]:
    """The stubs of a package that nodes import besides rclpy, by path in its folder."""
    return {
        _stub_path(path, folder): _text(derive.stub(path.read_text(encoding="utf-8")))
        for path in _modules(folder, folder.name).values()
    }


def _modules(folder: Path, package: str) -> dict[str, Path]:
    """The modules of a package, by name."""
    found: dict[str, Path] = {}
    for path in sorted(folder.rglob("*.py")):
        parts = [package, *path.relative_to(folder).with_suffix("").parts]
        found[".".join(parts[:-1] if parts[-1] == "__init__" else parts)] = path
    return found


def _is_public(name: str) -> bool:
    if name.startswith("rclpy.impl."):
        return name in _UPSTREAMS
    return not any(part.startswith("_") for part in name.split("."))


def _homes(name: str) -> Iterator[str]:
    """The modules that an import of this name loads, if they are modules: `rclpy`, `rclpy.qos`, ..."""
    parts = name.split(".")
    return (".".join(parts[:count]) for count in range(1, len(parts) + 1))


def _stub_path(path: Path, folder: Path) -> str:
    return path.relative_to(folder).with_suffix(".pyi").as_posix()


def _text(stub: ast.Module) -> str:
    return f"{_HEADER}{ast.unparse(ast.fix_missing_locations(stub))}\n"
