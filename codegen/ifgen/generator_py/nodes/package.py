"""From the nodes of a package to the files of an ament_python package."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from types import MappingProxyType

from ifgen.definition.interfaces import InterfacePackage
from ifgen.generator_py.artifact import Artifact
from ifgen.generator_py.nodes.classes import base_module, user_module
from ifgen.generator_py.nodes.context import NodePackageFiles
from ifgen.generator_py.nodes.custom_checks import checks_modules
from ifgen.generator_py.nodes.package_files import node_files, package_files, resource_name
from ifgen.generator_py.nodes.parameters import declared, parameters_module
from ifgen.nodl.model import NodeDescription, NodePackage


def plan_nodes(
    package: NodePackage,
    interfaces: InterfacePackage | None = None,
    ensured: tuple[str, ...] = (),
    requirements: Mapping[str, str] = MappingProxyType({}),
) -> tuple[Artifact, ...]:
    """The files of a package with nodes that are generated each time.

    `interfaces` are those of the package, if it has any. Their modules are not among the files, and are in
    the inner folder, which has the name of the package. On import, it makes sure that the packages `ensured`
    can be imported. `requirements` says what pip installs for packages that its package.xml declares.
    """
    files = package_files(package, interfaces, requirements)
    files = replace(files, ensured=tuple(f'"{name}"' for name in ensured))
    return tuple(_artifacts(package, interfaces, files))


def plan_users_files(package: NodePackage) -> tuple[Artifact, ...]:
    """The files that are the user's once they are written: the nodes, and functions of custom validators."""
    inner = package.name
    nodes = (
        _artifact(package, f"{inner}/{node.business_file}", "node.py", node=user_module(node))
        for node in package.nodes
    )
    checks = (
        _artifact(package, f"{inner}/{path}", "checks.py", package=module)
        for path, module in checks_modules(package).items()
    )
    return (*nodes, *checks)


def _artifacts(
    package: NodePackage, interfaces: InterfacePackage | None, files: NodePackageFiles
) -> Iterator[Artifact]:
    inner = package.name
    variables = {"package": files}
    yield _artifact(package, "package.xml", "package.xml", **variables)
    yield _artifact(package, "setup.py", "setup.py", **variables)
    yield _artifact(package, "setup.cfg", "setup.cfg", **variables)
    yield _artifact(package, f"resource/{package.name}", "marker", **variables)
    yield _artifact(package, f"launch/{package.name}.launch.py", "launch.py", **variables)
    if interfaces is None:
        yield _artifact(package, f"{inner}/__init__.py", "package.py", **variables)
        yield _artifact(package, f"{inner}/py.typed", "marker", **variables)
    if any(node.style == "asyncio" for node in package.nodes):
        yield _artifact(package, f"{inner}/_waiting.py", "waiting.py", **variables)
    for node in package.nodes:
        yield from _node_artifacts(package, node, inner)


def _node_artifacts(package: NodePackage, node: NodeDescription, inner: str) -> Iterator[Artifact]:
    files = node_files(node)
    yield _artifact(package, f"nodl/{node.name}.nodl.yaml", "nodl.yaml", node=files)
    yield _artifact(package, f"resource/{resource_name(package, node)}", "nodl.yaml", node=files)
    if declared(node):
        yield _artifact(package, f"config/{node.name}.yaml", "config.yaml", node=files)
        parameters = parameters_module(node)
        yield _artifact(package, f"{inner}/_{node.name}_parameters.py", "parameters.py", node=parameters)
    yield _artifact(package, f"{inner}/_{node.name}_base.py", "base.py", node=base_module(node))


def _artifact(of: NodePackage, path: str, template: str, **variables: object) -> Artifact:
    own_package = of.name if path.endswith(".py") else None
    return Artifact(path, f"node_package/{template}.j2", variables, own_package)
