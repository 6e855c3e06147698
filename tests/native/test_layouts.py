"""Our tables have the layout of the installed ROS's, by its headers and by the contents of its libraries."""

from __future__ import annotations

import ctypes
import shutil
import subprocess
import sys
from ctypes import addressof
from pathlib import Path
from typing import ClassVar

import pytest
from ifgen_runtime.real_rclpy import probe, tables

from .support import ROOT, needs_rclpy, run_python

HEADERS = Path(sys.prefix) / "include"  # where the wheels put them
COMPILER = shutil.which("c++")

# Ours (in C), ROS's, and the members of both in order.
STRUCTURES = {
    ("message_handle", "rosidl_message_type_support_t"): {
        "identifier": "typesupport_identifier",
        "data": "data",
        "find": "func",
        "type_hash": "get_type_hash_func",
        "type_description": "get_type_description_func",
        "type_sources": "get_type_description_sources_func",
    },
    ("message_callbacks", "message_type_support_callbacks_t"): {
        "namespace_": "message_namespace_",
        "name": "message_name_",
        "serialize": "cdr_serialize",
        "deserialize": "cdr_deserialize",
        "serialized_size": "get_serialized_size",
        "max_serialized_size": "max_serialized_size",
        "key_callbacks": "key_callbacks",
    },
    ("service_event_info", "rosidl_service_introspection_info_t"): {
        "event_type": "event_type",
        "stamp_sec": "stamp_sec",
        "stamp_nanosec": "stamp_nanosec",
        "client_gid": "client_gid",
        "sequence_number": "sequence_number",
    },
    ("service_handle", "rosidl_service_type_support_t"): {
        "identifier": "typesupport_identifier",
        "data": "data",
        "find": "func",
        "request": "request_typesupport",
        "response": "response_typesupport",
        "event": "event_typesupport",
        "event_create": "event_message_create_handle_function",
        "event_destroy": "event_message_destroy_handle_function",
        "type_hash": "get_type_hash_func",
        "type_description": "get_type_description_func",
        "type_sources": "get_type_description_sources_func",
    },
    ("service_callbacks", "service_type_support_callbacks_t"): {
        "namespace_": "service_namespace_",
        "name": "service_name_",
        "request": "request_members_",
        "response": "response_members_",
    },
    ("action_handle", "rosidl_action_type_support_t"): {
        "goal_service": "goal_service_type_support",
        "result_service": "result_service_type_support",
        "cancel_service": "cancel_service_type_support",
        "feedback_message": "feedback_message_type_support",
        "status_message": "status_message_type_support",
        "type_hash": "get_type_hash_func",
        "type_description": "get_type_description_func",
        "type_sources": "get_type_description_sources_func",
    },
}
# Ours (in Python), ROS's, and what its names of members have at the end.
TABLES = {
    tables.Member: ("rosidl_typesupport_introspection_c__MessageMember", "_"),
    tables.Members: ("rosidl_typesupport_introspection_c__MessageMembers", "_"),
    tables.Field: ("rosidl_runtime_c__type_description__Field", ""),
    tables.TypeDescription: ("rosidl_runtime_c__type_description__TypeDescription", ""),
    tables.TypeHash: ("rosidl_type_hash_t", ""),
}
INCLUDED = """
#include <cstddef>
#include <rosidl_runtime_c/action_type_support_struct.h>
#include <rosidl_runtime_c/message_type_support_struct.h>
#include <rosidl_runtime_c/service_type_support_struct.h>
#include <rosidl_runtime_c/type_description/type_description__struct.h>
#include <rosidl_typesupport_fastrtps_cpp/message_type_support.h>
#include <rosidl_typesupport_fastrtps_cpp/service_type_support.h>
#include <rosidl_typesupport_introspection_c/message_introspection.h>
#define _Static_assert static_assert
"""


@needs_rclpy
@pytest.mark.skipif(COMPILER is None, reason="there is no C++ compiler")
@pytest.mark.skipif(not (HEADERS / "rosidl_runtime_c").is_dir(), reason="ROS's headers are not here")
def test_layouts_are_those_of_the_headers(tmp_path: Path) -> None:
    lines = [INCLUDED, f'#include "{ROOT / "codegen/native/src/rosidl.h"}"']
    for (ours, theirs), members in STRUCTURES.items():
        lines += [same_place(theirs, its, f"offsetof({ours}, {mine})") for mine, its in members.items()]
    for table, (theirs, end) in TABLES.items():
        lines.append(f'static_assert(sizeof({theirs}) == {ctypes.sizeof(table)}, "{theirs}");')
        for name, *_ in table._fields_:
            member = name if name.endswith("_function") else name + end
            lines.append(same_place(theirs, member, getattr(table, name).offset))
    fastcdr = tmp_path / "fastcdr" / "Cdr.h"  # the wheels have no headers of it
    fastcdr.parent.mkdir()
    fastcdr.write_text("namespace eprosima { namespace fastcdr { class Cdr; } }\n")
    source = tmp_path / "layouts.cpp"
    source.write_text("\n".join(lines) + "\n")
    folders = [f"-I{folder}" for folder in (tmp_path, *HEADERS.iterdir()) if folder.is_dir()]
    command = [COMPILER or "", "-std=c++17", "-fsyntax-only", "-Wno-invalid-offsetof", *folders, str(source)]
    compiled = subprocess.run(command, capture_output=True, text=True, timeout=100, check=False)
    assert compiled.returncode == 0, compiled.stderr[-3000:]


@needs_rclpy
def test_the_installed_libraries_are_known() -> None:
    program = (
        "import ifgen; ifgen.activate('rclpy'); import rclpy; rclpy.init()\n"
        "from ifgen_runtime.real_rclpy.binding import member_layout\n"
        "print(member_layout().__name__)\n"
    )
    ran = run_python("-c", program)
    assert ran.stdout == "Member\n", ran.stderr


def same_place(structure: str, member: str, offset: object) -> str:
    """A line of C++ that does not compile if a member is elsewhere."""
    return f'static_assert(offsetof({structure}, {member}) == {offset}, "{structure}.{member}");'


class Introspection:
    """The handles of a ROS with some layout of members; replaces `probe._Library`."""

    identifier = 4711

    def __init__(self, layout: type[tables.Member], **unlike: int) -> None:
        members = (layout * 5)()
        handles = [self.handle("", "msg__Time"), 0, *[self.handle("", "msg__Parameter")] * 3]
        for member, handle, (type_id, is_array) in zip(members, handles, probe._EVENT_MEMBERS, strict=True):
            member.members, member.type_id, member.is_array = handle or None, type_id, is_array
        content = {"member_count": 5, "size_of": 104, "members": addressof(members), **unlike}
        self._keep = [members, tables.Members(**content)]
        self._words = (ctypes.c_size_t * 2)(self.identifier, addressof(self._keep[1]))

    def handle(self, package: str, name: str) -> int:
        return addressof(self._words) if name == "msg__ParameterEvent" else len(name)


class Wider(tables.MemberWithBuffer):
    """The members of a future ROS."""

    _fields_: ClassVar = [("news", ctypes.c_void_p)]


@pytest.mark.parametrize("layout", [tables.Member, tables.MemberWithBuffer])
def test_members_of_either_layout_are_told_apart(layout: type[tables.Member]) -> None:
    assert probe._member_layout(Introspection(layout)) is layout  # type: ignore[arg-type]


def test_members_of_another_layout_are_refused() -> None:
    with pytest.raises(probe.Unlike, match="a member takes neither 112 nor 120 bytes"):
        probe._member_layout(Introspection(Wider))  # type: ignore[arg-type]
    with pytest.raises(probe.Unlike, match="members has another layout"):
        probe._member_layout(Introspection(tables.Member, size_of=96))  # type: ignore[arg-type]


def test_words_that_are_not_what_they_should_be_are_refused() -> None:
    class Handles:
        identifier = 4711

        def handle(self, package: str, name: str, what: str = "message") -> int:
            return addressof(words)

    words = (ctypes.c_size_t * 11)(4712)
    for compare in (probe._check_message, probe._check_service):
        with pytest.raises(probe.Unlike, match="has another layout"):
            compare(Handles())  # type: ignore[arg-type]
    description = tables.TypeDescription()
    with pytest.raises(probe.Unlike, match="a type description has another layout"):
        probe._check_description(description)
