"""Where the files of ifgen-ros-runtime are: around this folder in a checkout, inside it in an sdist."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

_SOURCES = {"ifgen_runtime": "..", "libraries": "..", "underlay": "..", "generated": "../.."}
_TESTS = "test"
_FOR_TESTS = "test_msgs"
_ONLY_PACKAGES_OF_NODES_HAVE = "setup.py"


class Layout(BuildHookInterface):  # type: ignore[type-arg]  # hatchling's own does not say of what
    """Adds the files to a wheel or to an sdist, which has them as a checkout has."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Called by hatchling before it builds."""
        if version == "editable":
            return
        here = Path(self.root)
        in_sdist = (here / "PKG-INFO").is_file()
        sources = {name: here / ("." if in_sdist else place) / name for name, place in _SOURCES.items()}
        is_wheel = self.target_name == "wheel"
        # Under ifgen_runtime/, never at the top: a wheel must not install an `rclpy` or `std_msgs` that
        # shadows a real one.
        inner = "ifgen_runtime/" if is_wheel else ""
        included = {
            str(sources["ifgen_runtime"]): "ifgen_runtime",
            str(sources["underlay"]): f"{inner}underlay",
            str(sources["libraries"]): f"{inner}libraries",
        }
        for entry in _of_message_packages(sources["generated"]):
            included[str(entry)] = f"{inner}generated/{entry.relative_to(sources['generated']).as_posix()}"
        build_data["force_include"] |= included


def _of_message_packages(generated: Path) -> Iterator[Path]:
    """The files in each package of messages, without its tests; those of nodes go with the demo.

    A checkout has the messages of our own tests only after `make test`.
    """
    for package in sorted(generated.glob("[!.]*")):
        is_of_nodes = (package / _ONLY_PACKAGES_OF_NODES_HAVE).exists()
        if package.is_dir() and not is_of_nodes and package.name != _FOR_TESTS:
            yield from (entry for entry in sorted(package.iterdir()) if entry.name != _TESTS)
