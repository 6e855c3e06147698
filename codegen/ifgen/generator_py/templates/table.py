"""Every template that makes a file: what it makes, and its variables with their types.

The commands `ifgen templates ...` and the static check know templates by this table alone. Templates that are
not in it are parts, which one that is in it includes.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Final

from ifgen.generator_py.adapters import AdapterModule, AdapterPackage, AdapterTests, FrozenModule
from ifgen.generator_py.messages.context import FolderModule, InterfaceModule, PackageModule, ProjectFile
from ifgen.generator_py.nodes.context import (
    ChecksModule,
    NodeFiles,
    NodeModule,
    NodePackageFiles,
    ParametersModule,
)
from ifgen.generator_py.tests.context import InterfaceTests, NodeTests, OwnTests, TestSupport
from ifgen.model import Interface, Model, Node, Package


@dataclass(frozen=True, slots=True)
class Entry:
    """The files that a template makes, in words, and the types of its variables by name."""

    makes: str
    variables: Mapping[str, object]


_MODULE = {"module": InterfaceModule}
_PACKAGE = {"package": NodePackageFiles}
_FILES = {"node": NodeFiles}

TEMPLATES: Final[Mapping[str, Entry]] = {
    "message_package/package.py.j2": Entry("<package>/__init__.py", {"module": PackageModule}),
    "message_package/py.typed.j2": Entry("<package>/py.typed", {"module": PackageModule}),
    "message_package/pyproject.toml.j2": Entry("<package>/pyproject.toml", {"project": ProjectFile}),
    "message_package/folder.py.j2": Entry("<package>/<folder>/__init__.py", {"module": FolderModule}),
    "message_package/interface.py.j2": Entry("<package>/<folder>/_<interface>.py", _MODULE),
    "node_package/package.xml.j2": Entry("<package>/package.xml", _PACKAGE),
    "node_package/setup.py.j2": Entry("<package>/setup.py", _PACKAGE),
    "node_package/setup.cfg.j2": Entry("<package>/setup.cfg", _PACKAGE),
    "node_package/pyproject.toml.j2": Entry("<package>/pyproject.toml", {"project": ProjectFile}),
    "node_package/marker.j2": Entry("<package>/resource/<package>, and py.typed", _PACKAGE),
    "node_package/launch.py.j2": Entry("<package>/launch/<package>.launch.py", _PACKAGE),
    "node_package/package.py.j2": Entry("<package>/<package>/__init__.py", _PACKAGE),
    "node_package/waiting.py.j2": Entry("<package>/<package>/_waiting.py", _PACKAGE),
    "node_package/nodl.yaml.j2": Entry("<package>/nodl/<node>.nodl.yaml, and its resource", _FILES),
    "node_package/config.yaml.j2": Entry("<package>/config/<node>.yaml", _FILES),
    "node_package/parameters.py.j2": Entry(
        "<package>/<package>/_<node>_parameters.py", {"node": ParametersModule}
    ),
    "node_package/base.py.j2": Entry("<package>/<package>/_<node>_base.py", {"node": NodeModule}),
    "node_package/nodl_base.py.j2": Entry(
        "<package>/<package>/generated/<node>_base.py", {"node": NodeModule}
    ),
    "node_package/nodl_parameters.py.j2": Entry(
        "<package>/<package>/generated/<node>_base_parameters.py", {"node": NodeModule}
    ),
    "node_package/node.py.j2": Entry("<package>/<package>/<node>.py, once", {"node": NodeModule}),
    "node_package/checks.py.j2": Entry("<package>/<package>/<checks>.py, once", {"package": ChecksModule}),
    "test_package/interfaces.py.j2": Entry(
        "<package>/test/test_<package>_interfaces.py", {"test": InterfaceTests}
    ),
    "test_package/conftest.py.j2": Entry("<package>/test/conftest.py", {"test": TestSupport}),
    "test_package/contract.py.j2": Entry("<package>/test/test_<node>_contract.py", {"test": NodeTests}),
    "test_package/own.py.j2": Entry("<package>/test/test_<node>.py, once", {"test": OwnTests}),
    "adapter_package/package.py.j2": Entry("<adapters>/__init__.py, once", {"package": AdapterPackage}),
    "adapter_package/adapter.py.j2": Entry(
        "<adapters>/<interface>_<hash>.py, once", {"adapter": AdapterModule}
    ),
    "adapter_package/frozen.py.j2": Entry(
        "<adapters>/_<interface>_<hash>.py", {"module": InterfaceModule, "frozen": FrozenModule}
    ),
    "adapter_package/tests.py.j2": Entry(
        "<adapters>/test_adapt_<interface>_<hash>.py, once", {"test": AdapterTests}
    ),
}
"""ifgen's own."""

_OF_ALL = {"model": Model, "options": Mapping[str, Any]}

OUTPUT_VARIABLES: Final[Mapping[str, Mapping[str, object]]] = {
    "package": {"package": Package, **_OF_ALL},
    "interface": {"interface": Interface, "package": Package, **_OF_ALL},
    "node": {"node": Node, "package": Package, **_OF_ALL},
    "run": {"packages": tuple[Package, ...], **_OF_ALL},
}
"""The variables of the templates of `[tool.ifgen.outputs]`, by the `per` of their output."""
