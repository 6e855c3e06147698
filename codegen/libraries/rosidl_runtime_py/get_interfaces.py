"""The interfaces of packages: those in the index of ament, and those that ifgen has generated."""

from __future__ import annotations

import json
import sys
from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path

from ament_index_python import get_resource, get_resources, has_resource

__all__ = [
    "get_action_interfaces",
    "get_interface_packages",
    "get_interface_path",
    "get_interfaces",
    "get_message_interfaces",
    "get_service_interfaces",
]

_INDEX = "rosidl_interfaces"
_MANIFEST = ".ifgen-manifest.json"
_KINDS = ("msg", "srv", "action")


def get_interface_packages() -> dict[str, str]:
    """Return the packages with interfaces, by name: the prefix that each is installed in, or its folder."""
    return {**{name: str(manifest.parent) for name, manifest in _generated().items()}, **_indexed()}


def get_interfaces(package_names: Iterable[str] = ()) -> dict[str, list[str]]:
    """Return names such as `msg/String` by package, of these or of all. Raises LookupError."""
    generated, indexed = _generated(), _indexed()
    wanted = list(package_names)
    for name in wanted:
        is_known = name in generated or name in indexed
        with suppress(OSError):  # there is no index
            is_known = is_known or has_resource("packages", name) is not False
        if not is_known:
            raise LookupError(f"Unknown package '{name}'")
    found = {name: _names(name, generated, indexed) for name in wanted or sorted({*generated, *indexed})}
    return {name: names for name, names in found.items() if names}


def get_message_interfaces(package_names: Iterable[str] = ()) -> dict[str, list[str]]:
    """Return the names of messages by package, as `get_interfaces`."""
    return _of_kind("msg", package_names)


def get_service_interfaces(package_names: Iterable[str] = ()) -> dict[str, list[str]]:
    """Return the names of services by package, as `get_interfaces`."""
    return _of_kind("srv", package_names)


def get_action_interfaces(package_names: Iterable[str] = ()) -> dict[str, list[str]]:
    """Return the names of actions by package, as `get_interfaces`."""
    return _of_kind("action", package_names)


def get_interface_path(interface_name: str) -> str:
    """Return the path of the file that defines an interface; without a suffix, of its `.idl` if it has one.

    Raises ValueError for a malformed name, and LookupError where there is no such file.
    """
    package, *rest = interface_name.split("/")
    if not rest or not all((package, *rest)):
        raise ValueError(f"Invalid name '{interface_name}'. Expected at least two parts separated by '/'")
    name = "/".join(rest)
    has_suffix = "." in rest[-1]
    roots: list[Path] = []
    with suppress(OSError):  # there is no index
        if prefix := has_resource("packages", package):
            roots.append(Path(prefix, "share", package))
    if manifest := _generated().get(package):
        source = json.loads(manifest.read_text(encoding="utf-8")).get("source")
        roots += [manifest.parent, *([manifest.parents[1] / source] if isinstance(source, str) else [])]
    if not roots:
        raise LookupError(f"Unknown package '{package}'")
    kind = rest[0] if rest[0] in _KINDS else "msg"
    names = [name] if has_suffix else [f"{name}.idl", f"{name}.{kind}"]
    for root in roots:
        for each in names:
            if (root / each).is_file():
                return str((root / each).resolve() if ".." in root.parts else root / each)
    raise LookupError(f"Could not find the interface '{roots[0] / names[0]}'")


def _of_kind(kind: str, package_names: Iterable[str]) -> dict[str, list[str]]:
    found = {
        package: [name for name in names if name.startswith(f"{kind}/")]
        for package, names in get_interfaces(package_names).items()
    }
    return {package: names for package, names in found.items() if names}


def _names(package: str, generated: dict[str, Path], indexed: dict[str, str]) -> list[str]:
    if package in indexed:
        lines = get_resource(_INDEX, package)[0].splitlines()
        return sorted({line.rsplit(".", 1)[0] for line in lines if "_" not in line})
    if package in generated:
        listed = json.loads(generated[package].read_text(encoding="utf-8")).get("interfaces", ())
        return sorted(map(str, listed))
    return []


def _indexed() -> dict[str, str]:
    try:
        return get_resources(_INDEX)
    except OSError:  # no prefix is searched
        return {}


def _generated() -> dict[str, Path]:
    """The manifests of generated packages on `sys.path`, by name; the first one of a name counts."""
    found: dict[str, Path] = {}
    for entry in dict.fromkeys(sys.path):
        for manifest in Path(entry or ".").glob(f"*/{_MANIFEST}"):
            if any((manifest.parent / kind).is_dir() for kind in _KINDS):
                found.setdefault(manifest.parent.name, manifest)
    return found
