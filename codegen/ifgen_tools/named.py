"""Names in the graph with their types, of services and actions: how they are found and listed."""

from __future__ import annotations

import json
from collections.abc import Iterable
from dataclasses import asdict, dataclass

from ifgen_tools.errors import Absent, did_you_mean


@dataclass(frozen=True, slots=True)
class Named:
    """A service or an action in the graph: its name and its types, several if nodes disagree."""

    name: str
    types: list[str]


def named(names_and_types: Iterable[tuple[str, Iterable[str]]]) -> list[Named]:
    """The names that rclpy returns, sorted."""
    return sorted((Named(name, list(types)) for name, types in names_and_types), key=lambda each: each.name)


def print_named(
    found: Iterable[Named], *, show_types: bool = False, count: bool = False, as_json: bool = False
) -> None:
    """Print a line for each, or only how many there are."""
    found = list(found)
    if count:
        print(len(found))
    elif as_json:
        print(json.dumps([asdict(each) for each in found], indent=2))
    else:
        for each in found:
            print(f"{each.name} [{', '.join(each.types)}]" if show_types else each.name)


def of_type(found: Iterable[Named], type_name: str, kind: str) -> list[Named]:
    """Those with a type, `pkg/srv/Name` or for short `pkg/Name`; `kind` is `srv` or `action`."""
    package, _, name = type_name.partition("/")
    wanted = type_name if "/" in name else f"{package}/{kind}/{name}"
    return [each for each in found if wanted in each.types]


def pick(found: Iterable[Named], name: str, what: str) -> Named:
    """The one of this name; `what` is `service` or `action`. Raises ToolError that names near ones."""
    known = {each.name: each for each in found}
    full = name if name.startswith("/") else f"/{name}"
    if full not in known:
        near = did_you_mean(full, sorted(known))
        raise Absent(f"there is no {what} {full!r}", near or f"see `ifgen {what} list`")
    return known[full]
