"""The build backend of ifgen-ros: hatchling, and how ifgen-ros finds ifgen-ros-runtime, which it depends on.

Both come from one repository. What is built for an index depends on the same version there; a checkout must
install with nothing on an index, so:

| built                  | depends on                                                                  |
|------------------------|-----------------------------------------------------------------------------|
| an sdist, or from one  | ifgen-ros-runtime of the same version                                       |
| a wheel of a checkout  | the runtime in that checkout; by its origin, if pip has cloned it for this   |
| an editable            | what the runtime depends on: the runtime itself is in the checkout          |
"""

from __future__ import annotations

import os
import subprocess
import tomllib
from pathlib import Path
from typing import Any
from urllib.parse import quote

from hatchling import build as hatchling
from hatchling.build import (
    get_requires_for_build_editable,
    get_requires_for_build_sdist,
    get_requires_for_build_wheel,
)
from hatchling.builders.hooks.plugin.interface import BuildHookInterface
from hatchling.metadata.plugin.interface import MetadataHookInterface

__all__ = [
    "build_editable",
    "build_sdist",
    "build_wheel",
    "get_requires_for_build_editable",
    "get_requires_for_build_sdist",
    "get_requires_for_build_wheel",
]

_RUNTIME = "codegen/runtime"
_KIND = "IFGEN_BUILD"  # hatchling loads the hooks below as a module of their own, in this process
_NODES_HAVE = "setup.py"
_OF_URLS = ":/@~?&=%"  # git has decoded the rest
_CLONES_OF_PIP = ("pip-install-", "pip-req-build-")


def build_sdist(*arguments: Any, **options: Any) -> str:
    """Build an sdist, whose metadata every wheel built from it gets."""
    os.environ[_KIND] = "sdist"
    return hatchling.build_sdist(*arguments, **options)


def build_wheel(*arguments: Any, **options: Any) -> str:
    """Build a wheel."""
    os.environ[_KIND] = "sdist" if Path("PKG-INFO").is_file() else "checkout"
    return hatchling.build_wheel(*arguments, **options)


def build_editable(*arguments: Any, **options: Any) -> str:
    """Build what lets Python import from the checkout."""
    os.environ[_KIND] = "editable"
    return hatchling.build_editable(*arguments, **options)


class Dependencies(MetadataHookInterface):
    """Completes `dependencies`, which pyproject.toml keeps in the table of this hook."""

    def update(self, metadata: dict[str, Any]) -> None:
        """Called by hatchling for the metadata of the project."""
        root = Path(self.root)
        with (root / _RUNTIME / "pyproject.toml").open("rb") as file:
            runtime = tomllib.load(file)["project"]
        match os.environ.get(_KIND, "sdist"):
            case "editable":
                added = runtime["dependencies"]
            case "checkout":
                added = [f"{runtime['name']} @ {_location(root)}"]
            case _:
                added = [f"{runtime['name']}=={runtime['version']}"]
        metadata["dependencies"] = [*self.config["dependencies"], *added]


class Folders(BuildHookInterface):  # type: ignore[type-arg]  # hatchling's own does not say of what
    """Adds to a wheel what its table says, and the demo's packages of nodes; messages are in the runtime."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Called by hatchling before it builds."""
        if version == "editable":
            return
        build_data["force_include"] |= self.config["folders"]
        for package in sorted((Path(self.root) / "generated").iterdir()):
            for entry in sorted(package.iterdir()) if (package / _NODES_HAVE).is_file() else ():
                if entry.name != "test":
                    build_data["force_include"][str(entry)] = f"ifgen/generated/{package.name}/{entry.name}"


def _location(root: Path) -> str:
    """The runtime of a checkout; of a clone that pip throws away, the one in its origin."""
    if any(part.startswith(_CLONES_OF_PIP) for part in root.parts):
        origin, commit = _git(root, "remote", "get-url", "origin"), _git(root, "rev-parse", "HEAD")
        return f"git+{quote(origin, safe=_OF_URLS)}@{commit}#subdirectory={_RUNTIME}"
    return (root / _RUNTIME).as_uri()


def _git(root: Path, *arguments: str) -> str:
    done = subprocess.run(["git", "-C", root, *arguments], capture_output=True, text=True, check=True)
    return done.stdout.strip()
