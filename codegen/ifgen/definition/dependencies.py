"""The dependencies that a package has to declare so that colcon builds its interfaces."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import Final

from ifgen.diagnostics import Diagnostic, Label
from ifgen.reading import package_xml
from ifgen.reading.package_xml import PackageXml
from ifgen.reading.packages import PackageFiles
from ifgen.reading.search_path import SearchPath

# The packages that the generators need: rosidl finds these itself for services and actions.
_OF_GENERATORS: Final = ("action_msgs", "service_msgs", "builtin_interfaces", "unique_identifier_msgs")
_OF_CLIENT_LIBRARIES: Final = (
    *_OF_GENERATORS,
    *("rcl_interfaces", "rosgraph_msgs", "statistics_msgs", "type_description_interfaces"),
)
_TOOLS: Final = ("ament_", "python3", "rosidl_")


def check(package: PackageFiles, uses: Mapping[str, Label], search: SearchPath) -> Iterator[Diagnostic]:
    """The missing declarations of a package; `uses` maps packages whose types it names to the first place."""
    listed = package.listed
    if package.xml is None:
        return
    in_group = package_xml.INTERFACES in package.xml.groups
    if listed is not None and listed.span is not None and listed.checks_group and not in_group:
        yield _not_in_group(package, Label(listed.span))
    declared = _reachable(package.xml.dependencies, search)
    passed = None
    if listed is not None and listed.dependencies is not None:
        passed = _reachable((*listed.dependencies, *_OF_GENERATORS), search)
    for name, label in uses.items():
        missing_in_xml = declared is not None and name not in declared
        missing_in_list = passed is not None and name not in passed
        if name != package.name and (missing_in_xml or missing_in_list):
            yield _undeclared(package, name, label, missing_in_xml, missing_in_list)


def asked(package: PackageFiles, search: SearchPath) -> str:
    """The questions of `check` about other packages, with the answers.

    While the answers stay, its result stays.
    """
    if package.xml is None:
        return ""
    listed = package.listed.dependencies if package.listed else None
    pending = [*package.xml.dependencies, *(listed or ()), *_OF_GENERATORS]
    answers: dict[str, object] = {}
    while pending:
        name = pending.pop()
        if name not in answers:
            xml = search.package_xml(name)
            answers[name] = sorted(xml.dependencies) if xml else search.package(name) is not None
            pending += _brought_by(name, xml)
    return repr((sorted(package.xml.groups), sorted(package.xml.dependencies), sorted(answers.items())))


def _reachable(names: Iterable[str], search: SearchPath) -> set[str] | None:
    """The packages that some packages depend on; None if one of those is unknown here.

    A package that another one declares is there when it is built, so colcon misses nothing.
    """
    found: set[str] = set()
    pending = list(names)
    while pending:
        name = pending.pop()
        if name in found:
            continue
        found.add(name)
        xml = search.package_xml(name)
        if name == package_xml.INTERFACES:
            return None
        brought = _brought_by(name, xml)
        if not brought and xml is None and search.package(name) is None:
            return None
        pending += brought
    return found


def _brought_by(name: str, xml: PackageXml | None) -> Iterable[str]:
    """The packages that one depends on, as far as is known."""
    if name.startswith(_TOOLS):
        return _OF_GENERATORS
    if name.startswith("rcl"):
        return _OF_CLIENT_LIBRARIES
    return xml.dependencies if xml is not None else ()


def _undeclared(package: PackageFiles, name: str, label: Label, in_xml: bool, in_list: bool) -> Diagnostic:
    assert package.xml is not None
    advice: list[str] = []
    places: list[Label] = []
    if in_xml:
        advice.append(f"`<depend>{name}</depend>` to package.xml")
        places.append(Label(package.xml.span, "does not declare it"))
    if in_list and package.listed is not None and package.listed.span is not None:
        advice.append(
            f"`find_package({name} REQUIRED)` to CMakeLists.txt and `{name}` to the DEPENDENCIES there"
        )
        places.append(Label(package.listed.span, "does not depend on it"))
    return Diagnostic(
        "undeclared-dependency",
        f"{package.name} uses package '{name}' without declaring it",
        label,
        tuple(places),
        f"add {', '.join(advice)}: colcon may build this package first, or not at all",
        "warning",
    )


def _not_in_group(package: PackageFiles, label: Label) -> Diagnostic:
    return Diagnostic(
        "not-in-group",
        f"{package.name} generates interfaces without being in the group {package_xml.INTERFACES}",
        label,
        help=f"add `<member_of_group>{package_xml.INTERFACES}</member_of_group>` to package.xml: "
        "rosidl refuses to go on without it",
        severity="warning",
    )
