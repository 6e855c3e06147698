"""From the nodes of a package to the files of an ament_python package."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from html import escape
from types import MappingProxyType

from ifgen.definition.interfaces import InterfacePackage, Message
from ifgen.definition.references import references
from ifgen.generator_py.artifact import Artifact
from ifgen.generator_py.nodes.classes import base_module, user_module
from ifgen.generator_py.nodes.context import ChecksModule, NodeFiles, NodePackageFiles
from ifgen.generator_py.nodes.parameters import annotation, config_lines, declared, parameters_module
from ifgen.generator_py.text import docstring, literal, quoted
from ifgen.nodl.model import NodeDescription, NodePackage, PackageMetadata, Parameter, Validator
from ifgen.nodl.yaml_lines import description_lines
from ifgen.reading.package_xml import Dependency


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
    files = replace(
        _package_files(package, interfaces, requirements), ensured=tuple(f'"{name}"' for name in ensured)
    )
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
    if any(node.style == "nodl" for node in package.nodes):
        yield _artifact(package, f"{inner}/generated/__init__.py", "marker", **variables)
    for node in package.nodes:
        yield from _node_artifacts(package, node, inner)
    for part in package.parts:
        yield from _documents(package, part, _node_files(part))


def _node_artifacts(package: NodePackage, node: NodeDescription, inner: str) -> Iterator[Artifact]:
    files = _node_files(node)
    yield from _documents(package, node, files)
    if declared(node):
        yield _artifact(package, f"config/{node.name}.yaml", "config.yaml", node=files)
        parameters = parameters_module(node)
        yield _artifact(package, f"{inner}/_{node.name}_parameters.py", "parameters.py", node=parameters)
    base = base_module(node)
    yield _artifact(package, f"{inner}/_{node.name}_base.py", "base.py", node=base)
    if node.style == "nodl":
        generated = f"{inner}/generated/{node.name}_base"
        yield _artifact(package, f"{generated}.py", "nodl_base.py", node=base)
        if declared(node):
            yield _artifact(package, f"{generated}_parameters.py", "nodl_parameters.py", node=base)


def _documents(package: NodePackage, node: NodeDescription, files: NodeFiles) -> Iterator[Artifact]:
    yield _artifact(package, f"nodl/{node.name}.nodl.yaml", "nodl.yaml", node=files)
    yield _artifact(package, f"resource/{resource_name(package, node)}", "nodl.yaml", node=files)


def _artifact(of: NodePackage, path: str, template: str, **variables: object) -> Artifact:
    own_package = of.name if path.endswith(".py") else None
    return Artifact(path, f"node_package/{template}.j2", variables, own_package)


_OF_ALL = {"rclpy", "launch", "launch_ros", "python3-hypothesis", "python3-pytest"}
_VERSION = re.compile(r"\d+\.\d+\.\d+")


def _package_files(
    package: NodePackage, interfaces: InterfacePackage | None, requirements: Mapping[str, str]
) -> NodePackageFiles:
    """The contents of the files of a package; `interfaces` are those beside its nodes.

    `requirements` says what pip installs for packages that its package.xml declares.
    """
    metadata = package.metadata or PackageMetadata()
    # The package of a base class has, by ROS' habit, the name of its module.
    bases = {node.base.module.partition(".")[0] for node in package.nodes if node.base}
    depends = tuple(sorted((uses(package, interfaces) | bases) - {package.name, "rclpy"}))
    further = further_dependencies(metadata, {*depends, package.name})
    required = requirements_of(further, requirements)
    description = metadata.description or f"Nodes of {package.name}."
    maintainer = metadata.maintainer_name or f"maintainers of {package.name}"
    email = metadata.maintainer_email or "maintainers@example.com"
    license_ = metadata.license or "Proprietary"
    with_parameters = [node for node in package.nodes if declared(node)]
    documents = (*package.nodes, *package.parts)
    return NodePackageFiles(
        name=package.name,
        title=f"The package {package.name}: generated by ifgen, do not edit.",
        waiting_title=f"Waiting for others in the nodes of {package.name}: generated by ifgen, do not edit.",
        version=version_of(metadata.version),
        description=description,
        description_literal=quoted(description),
        maintainer_name=maintainer,
        maintainer_name_literal=quoted(maintainer),
        maintainer_email=email,
        maintainer_email_literal=quoted(email),
        license=license_,
        license_literal=quoted(license_),
        depends=depends,
        further=tuple(map(_element, further)),
        requires=_list(("setuptools", *required)),
        registered=_list(f"resource/{resource_name(package, node)}" for node in documents),
        descriptions=_list(f"nodl/{node.name}.nodl.yaml" for node in documents),
        configs=_list(f"config/{node.name}.yaml" for node in with_parameters) if with_parameters else "",
        nodes=tuple(map(_node_files, package.nodes)),
    )


def _node_files(node: NodeDescription) -> NodeFiles:
    """The contents of the files of a package about one of its nodes."""
    return NodeFiles(
        name=node.name,
        module=node.business_file.removesuffix(".py"),
        title=f"{node.name}: generated by ifgen, do not edit.",
        is_managed=node.style == "lifecycle",
        has_parameters=bool(declared(node)),
        config=tuple(config_lines(node)),
        document=tuple(description_lines(node)),
    )


def resource_name(package: NodePackage, node: NodeDescription) -> str:
    """Under which name the ament index has the description of a node."""
    return f"{package.name}__{node.name}"


def version_of(declared: str) -> str:
    """A Python version from the version in a package.xml."""
    return declared if _VERSION.fullmatch(declared) else "0.0.0"


def uses(nodes: NodePackage | None, interfaces: InterfacePackage | None) -> set[str]:
    """The packages whose interfaces a package uses, itself perhaps included."""
    described = nodes.nodes if nodes else ()
    found = {endpoint.type_name.partition("/")[0] for node in described for endpoint in node.endpoints}
    if any(map(declared, described)):
        found.add("rcl_interfaces")
    if any(node.style == "asyncio" for node in described):
        found.add("action_msgs")
    for interface in interfaces.interfaces if interfaces else ():
        for message in (interface,) if isinstance(interface, Message) else interface.messages:
            found.update(type_.package for _, type_ in references(message))
    return found


def further_dependencies(metadata: PackageMetadata, known: set[str]) -> tuple[Dependency, ...]:
    """The dependencies in a package.xml, less those that each package of nodes, or this one, has anyway."""
    return tuple(found for found in metadata.dependencies if found.name not in known | _OF_ALL)


def requirements_of(dependencies: Iterable[Dependency], requirements: Mapping[str, str]) -> list[str]:
    """The requirements for pip of those dependencies that the package runs with and the settings name."""
    running = (found for found in dependencies if found.tag != "test_depend")
    return [requirement for found in running if (requirement := requirements.get(found.name))]


def _element(dependency: Dependency) -> str:
    attributes = "".join(f' {key}="{escape(value)}"' for key, value in dependency.attributes)
    return f"<{dependency.tag}{attributes}>{escape(dependency.name)}</{dependency.tag}>"


def _list(names: Iterable[str]) -> str:
    return literal(tuple(names))


def checks_modules(package: NodePackage) -> Mapping[str, ChecksModule]:
    """The modules of this package with functions of custom validators, by path in its inner folder."""
    functions: dict[str, dict[str, tuple[str, str, str]]] = {}
    for parameter, validator, module, name in _check_functions(package):
        text = (name, _check_parameters(parameter, validator), _check_docstring(parameter, validator))
        functions.setdefault(module, {}).setdefault(name, text)
    return {
        f"{module.replace('.', '/')}.py": ChecksModule(
            f"Checks of parameters of {package.name}: written once by ifgen, yours from then on.",
            tuple(of_module.values()),
        )
        for module, of_module in functions.items()
    }


def _check_functions(package: NodePackage) -> Iterator[tuple[Parameter, Validator, str, str]]:
    for node in package.nodes:
        for parameter in declared(node):
            for validator in parameter.validators:
                path = validator.function or ""
                if path.startswith(f"{package.name}."):
                    module, _, name = path.removeprefix(f"{package.name}.").rpartition(".")
                    if module:
                        yield parameter, validator, module, name


def _check_parameters(parameter: Parameter, validator: Validator) -> str:
    arguments = (
        f"argument{number}: {type(value).__name__}" for number, value in enumerate(validator.arguments, 1)
    )
    return ", ".join([f"value: {annotation(parameter.type)}", *arguments])


def _check_docstring(parameter: Parameter, validator: Validator) -> str:
    given = f" with {', '.join(map(literal, validator.arguments))}" if validator.arguments else ""
    text = (
        f"Check `{parameter.name}` ({validator.name}{given}); raise ValueError with the reason to refuse it."
    )
    return docstring(text, indent=4)
