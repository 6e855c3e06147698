"""`ifgen check --fix`: what it fixes is found no more, the rest of a file stays, and twice is as once."""

from __future__ import annotations

import difflib
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from .conftest import Run, write

FIXED = {"undeclared-dependency", "not-in-group", "invalid-type"}
XML = (
    '<?xml version="1.0"?>\n<package format="3">\n  <name>demo_msgs</name>\n  <version>0.0.0</version>\n'
    "  <description>d</description>\n  <maintainer email='a@b.c'>m</maintainer>\n  <license>MIT</license>\n"
    "{depends}  <!-- <depend>geometry_msgs</depend> -->\n{export}</package>\n"
)
CMAKE = "cmake_minimum_required(VERSION 3.8)\nproject(demo_msgs)\nfind_package(rosidl_default_generators REQUIRED)\n{call}"
CALLS = (
    "rosidl_generate_interfaces(${PROJECT_NAME} msg/A.msg)\n",
    'rosidl_generate_interfaces(${PROJECT_NAME}\n  "msg/A.msg"  # first\n)\n',
    "if(TRUE)\n\trosidl_generate_interfaces(${PROJECT_NAME} msg/A.msg\n\t\tDEPENDENCIES\n\t\tbuiltin_interfaces)\nendif()\n",
    "rosidl_generate_interfaces(${PROJECT_NAME} msg/A.msg DEPENDENCIES builtin_interfaces ADD_LINTER_TESTS)",
    "# rosidl_generate_interfaces(x DEPENDENCIES y)\nROSIDL_generate_interfaces(${PROJECT_NAME} msg/A.msg # why (\n)\n",
)
DEPENDS = (
    "",
    "  <depend>builtin_interfaces</depend>\n",
    "\t<build_depend>builtin_interfaces</build_depend>\n",
)
EXPORTS = (
    "",
    "  <export><build_type>ament_cmake</build_type></export>\n",
    "<member_of_group>rosidl_interface_packages</member_of_group>",
)
TYPES = (
    "std_msgs/Header",
    "std_msgs::Header",
    "geometry_msgs::msg::Pose",
    "sensor_msgs/Imu",
    "geometry_msgs/Twist",
)


@settings(max_examples=15, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    types=st.lists(st.tuples(st.sampled_from(TYPES), st.sampled_from(["", "[]", "[<=3]"])), max_size=4),
    call=st.sampled_from(CALLS),
    depends=st.sampled_from(DEPENDS),
    export=st.sampled_from(EXPORTS),
    crlf=st.booleans(),
)
def test_what_it_fixes_is_found_no_more(
    types: list[tuple[str, str]],
    call: str,
    depends: str,
    export: str,
    crlf: bool,
    ifgen: Run,
    tmp_path_factory: pytest.TempPathFactory,
) -> None:
    root = tmp_path_factory.mktemp("ws") / "demo_msgs"
    texts = {
        "msg/A.msg": "".join(f"{name}{size} f{i} # {name}\n" for i, (name, size) in enumerate(types))
        + "int8 x\n",
        "package.xml": XML.format(depends=depends, export=export),
        "CMakeLists.txt": CMAKE.replace("{call}", call),
    }
    for name, text in texts.items():
        (root / name).parent.mkdir(parents=True, exist_ok=True)
        (root / name).write_bytes(text.replace("\n", "\r\n" if crlf else "\n").encode())
    before = {name: (root / name).read_bytes() for name in texts}
    diff = ifgen("check", "--diff", root)
    assert {name: (root / name).read_bytes() for name in texts} == before
    done = ifgen("check", "--fix", root)
    after = {name: (root / name).read_bytes() for name in texts}
    assert not [rule for rule in FIXED if f"[{rule}]" in done.out], done
    assert bool(diff.out.count("+++")) == (after != before)
    for name in texts:
        lines = before[name].splitlines(), after[name].splitlines()
        assert after[name].count(b"\r\n") == (after[name].count(b"\n") if crlf else 0)
        changed = [
            line for line in difflib.ndiff(*[[x.decode() for x in side] for side in lines]) if line[:1] == "-"
        ]
        assert all(
            "::" in line or "rosidl_generate" in line.lower() or ")" in line or "<export" in line
            for line in changed
        ), changed
    ifgen("check", "--fix", root)
    assert {name: (root / name).read_bytes() for name in texts} == after, "twice is as once"


def test_what_cannot_be_fixed_stays_reported(ifgen: Run, tmp_path: Path) -> None:
    write(tmp_path / "a_msgs/msg/A.msg", "std_msgs::Header h\nabsent::Foo foo\n")
    done = ifgen("check", "--fix", tmp_path)
    assert (done.code, "there is no interface package 'absent'" in done.out) == (1, True)
    assert (tmp_path / "a_msgs/msg/A.msg").read_text() == "std_msgs/Header h\nabsent/Foo foo\n"
