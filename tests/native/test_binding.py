"""If type support cannot work, the caller of rclpy gets one sentence: why, and what to do."""

from __future__ import annotations

from importlib.metadata import version

import pytest
from ifgen_runtime.installation import add_native

from .support import PROGRAMS, needs_rclpy, run_python

pytestmark = needs_rclpy


@pytest.fixture(scope="module")
def said() -> dict[str, str]:
    """The output of the program, by case."""
    ran = run_python(str(PROGRAMS / "refusals.py"))
    assert ran.returncode == 0, ran.stdout + ran.stderr
    return dict(line.split("|", 1) for line in ran.stdout.splitlines())


def unknown(problem: str) -> str:
    return (
        f"TypeSupportError|ifgen-ros-native {version('ifgen-ros-native')} does not know this ROS 2"
        f" ({problem}); rclpy here is {version('ros-rclpy')}; a newer ifgen-ros-native may know it, and a package built with colcon does not need it"
    )


def test_a_missing_extension_is_named_with_the_command_that_installs_it(said: dict[str, str]) -> None:
    assert said["missing"].startswith(
        "TypeSupportError|real rclpy needs ifgen's type support, which is not installed:"
        f" run `{add_native()}`; Python says: No module named 'ifgen_native"
    )


def test_an_extension_of_another_release_is_refused(said: dict[str, str]) -> None:
    assert said["release"] == (
        f"TypeSupportError|ifgen-ros-native {version('ifgen-ros-native')} and ifgen-ros-runtime"
        f" {version('ifgen-ros-runtime')} do not fit together: install the same release of both"
    )


def test_a_middleware_that_needs_c_structures_is_refused(said: dict[str, str]) -> None:
    assert said["cyclonedds"] == said["service"]
    assert said["cyclonedds"] == (
        "TypeSupportError|rmw_cyclonedds_cpp reads and writes messages as C structures, which never-compiled"
        " classes do not have; set RMW_IMPLEMENTATION=rmw_fastrtps_cpp, or build the package with colcon"
    )


def test_layouts_decide_and_not_the_name_of_a_distribution(said: dict[str, str]) -> None:
    assert said["distribution"] == "works"
    assert said["layout"] == unknown("a type hash has another layout")


def test_libraries_that_are_missing_or_lack_a_function_are_named(said: dict[str, str]) -> None:
    assert said["library"] == (
        "TypeSupportError|libfastcdr.so.2 of ROS 2 cannot be loaded (libfastcdr.so.2: cannot open shared"
        " object file); is ROS sourced, or are its wheels installed?"
    )
    assert said["symbol"] == unknown("libfastcdr.so.2 has no _ZN8eprosima7fastcdr3Cdr4leapEm")


@pytest.mark.parametrize(
    ("case", "problem"),
    [
        ("data twice", "the members of Cdr and FastBuffer are not where one value each tells them"),
        ("size twice", "the members of Cdr and FastBuffer are not where one value each tells them"),
        ("position", "get_current_position does not start at the buffer"),
        ("jump", "jump does not move by the bytes asked for"),
        ("unchecked", "jump leaves the buffer"),
    ],
)
def test_a_libfastcdr_with_other_objects_is_refused_with_versions(
    case: str, problem: str, said: dict[str, str]
) -> None:
    assert said[case] == unknown(problem)


def test_a_refusal_leaves_nothing_behind(said: dict[str, str]) -> None:
    assert said["after all"] == "works"


def test_types_beyond_the_slots_are_refused_and_known_ones_go_on(said: dict[str, str]) -> None:
    assert said["messages"] == "4095"  # one was in use
    assert said["no slot"] == (
        "TypeSupportError|no type support for FootstepPlan: this process uses more than 4096 message types,"
        " which is all that ifgen_native has room for; run some of its nodes in another process"
    )
    assert said["known"] == "works"
    assert said["services"].startswith("1024|this process uses more than 1024 services, which is all")
