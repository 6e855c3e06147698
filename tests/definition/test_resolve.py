"""From packages to a closed registry: which files are read, and which are not."""

from __future__ import annotations

from pathlib import Path

import pytest
from ifgen.definition.interfaces import Action, Registry, Service
from ifgen.definition.resolve import resolve
from ifgen.definition.type_description import describe, described_types, type_hash
from ifgen.diagnostics import InputError
from ifgen.reading.packages import find_packages
from ifgen.reading.search_path import SearchPath


def load(
    folder: Path, files: dict[str, str], *paths: str, include: str = "", whole: bool = False
) -> Registry:
    """Write files and resolve the packages at `paths`, or all of them."""
    for name, text in files.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text, encoding="utf-8")
    packages = find_packages([folder / path for path in paths or ("",)])
    return resolve(packages, SearchPath(packages, [folder / include] if include else []), whole)


FILES = {
    "top_msgs/msg/Top.msg": "low_msgs/Mid mid\n",
    "more/low_msgs/msg/Mid.msg": "Low[] lows\n",
    "more/low_msgs/msg/Low.msg": "uint8 a\n",
    "more/low_msgs/msg/Other.msg": "far_msgs/Far far\n",
    "more/far_msgs/msg/Far.msg": "",
    "more/bad_msgs/msg/Bad.msg": "int a\n",
}


def test_only_what_is_needed_is_read(tmp_path: Path) -> None:
    """Of a dependency, only the files that fields need are read."""
    registry = load(tmp_path, FILES, "top_msgs", include="more")
    assert [interface.type_name for interface in registry] == [
        "top_msgs/msg/Top",
        "low_msgs/msg/Low",
        "low_msgs/msg/Mid",
    ]
    assert registry.requested == ("top_msgs",)
    assert {name: package.complete for name, package in registry.packages.items()} == {
        "top_msgs": True,
        "low_msgs": False,
    }


def test_whole_dependencies(tmp_path: Path) -> None:
    """With whole dependencies, all their files are read, and the files that those need."""
    registry = load(tmp_path, FILES, "top_msgs", include="more", whole=True)
    assert list(registry.packages) == ["top_msgs", "low_msgs", "far_msgs"]
    assert all(package.complete for package in registry.packages.values())


def test_a_single_file_brings_what_it_needs(tmp_path: Path) -> None:
    """A file stands for its package; its siblings are read only if it needs them."""
    registry = load(tmp_path, FILES, "more/low_msgs/msg/Mid.msg")
    assert [interface.name for interface in registry.packages["low_msgs"].interfaces] == ["Low", "Mid"]
    assert not registry.packages["low_msgs"].complete


def test_services_and_actions_bring_their_support(tmp_path: Path) -> None:
    """The registry has the types that derived messages name and that rclpy's actions use."""
    registry = load(
        tmp_path, {"demo_msgs/srv/Add.srv": "---\n", "demo_msgs/action/Walk.action": "---\n---\n"}
    )
    service, action = registry.interface("demo_msgs/srv/Add"), registry.interface("demo_msgs/action/Walk")
    assert isinstance(service, Service) and isinstance(action, Action)
    assert [d.type_name.rpartition("/")[2] for d in described_types(service)] == [
        *["Add", "Add_Request", "Add_Response", "Add_Event"]
    ]
    assert sorted(d.type_name.rpartition("/")[2] for d in described_types(action)) == [
        *["Walk", "Walk_Feedback", "Walk_FeedbackMessage"],
        *["Walk_GetResult", "Walk_GetResult_Event", "Walk_GetResult_Request", "Walk_GetResult_Response"],
        *["Walk_Goal", "Walk_Result"],
        *["Walk_SendGoal", "Walk_SendGoal_Event", "Walk_SendGoal_Request", "Walk_SendGoal_Response"],
    ]
    assert registry.interface("action_msgs/srv/CancelGoal")
    assert registry.interface("action_msgs/msg/GoalStatusArray")
    assert registry.message("service_msgs/msg/ServiceEventInfo")
    assert registry.message("demo_msgs/action/Walk_FeedbackMessage").fields[1].name == "feedback"


def test_errors_of_all_files_come_at_once(tmp_path: Path) -> None:
    """Errors of the given packages and of their dependencies come first, then warnings."""
    files = {
        **FILES,
        "top_msgs/msg/Top.msg": "bad_msgs/Bad bad\nuint8 from\n",
        "top_msgs/msg/Two.msg": "uint8 a a\nmissing_msgs/A b\n",
    }
    with pytest.raises(InputError) as caught:
        load(tmp_path, files, "top_msgs", include="more")
    assert [diagnostic.rule for diagnostic in caught.value.diagnostics] == [
        *["invalid-value", "unknown-package", "invalid-type", "keyword-name"]
    ]


def test_warnings_are_about_what_was_asked_for(tmp_path: Path) -> None:
    """Warnings about a dependency do not concern the user."""
    files = {
        "top_msgs/msg/Top.msg": "low_msgs/Low low\nuint8 self\n",
        "more/low_msgs/msg/Low.msg": "uint8 from\n",
    }
    registry = load(tmp_path, files, "top_msgs", include="more")
    assert [warning.rule for warning in registry.warnings] == ["reserved-name"]


def test_long_chains_need_no_stack(tmp_path: Path) -> None:
    """A thousand and more messages in a chain are read and described."""
    length = 1_500
    files = {f"demo_msgs/msg/M{n}.msg": f"M{n + 1} next\n" for n in range(length)}
    registry = load(tmp_path, {**files, f"demo_msgs/msg/M{length}.msg": ""})
    description = describe(registry.message("demo_msgs/msg/M0"), registry)
    assert len(description["referenced_type_descriptions"]) == length


def test_an_empty_message_has_a_hash(tmp_path: Path) -> None:
    """The hash of a message without fields is that of its placeholder; comments, defaults and constants do not count."""
    files = {
        "example_interfaces/msg/E.msg": "",
        "example_interfaces/msg/F.msg": "uint8 structure_needs_at_least_one_member\n",
        "demo_msgs/msg/A.msg": "uint8 a\n",
        "other/demo_msgs/msg/A.msg": "# text\nuint8 B=1\nuint8 a 5 # more\n",
    }
    registry = load(tmp_path, files, "example_interfaces", "demo_msgs")
    empty = registry.message("example_interfaces/msg/E")
    assert (
        type_hash(empty, registry)
        == "RIHS01_ca84ad27a5df8d42de5262e3ae10d1153757fde31479e33eef563e98653f9554"
    )
    assert not registry.message("example_interfaces/msg/F").fields
    other = load(tmp_path, {}, "other")
    assert type_hash(registry.message("demo_msgs/msg/A"), registry) == type_hash(
        other.message("demo_msgs/msg/A"), other
    )
