"""Whether the tables of this process' ROS are laid out as ours, asked of compiled types that rclpy brings.

Distributions differ in tables of the same name, and a wrong one is a crash. So a message, a service and the
members of a message are looked up, and each word that can be known in advance is compared. A word is followed
as a pointer only after its neighbours have been found to be what they should be.
"""

from __future__ import annotations

from collections.abc import Callable
from ctypes import CDLL, CFUNCTYPE, c_size_t, c_void_p, sizeof, string_at
from typing import Any, Final

from ifgen_runtime.real_rclpy import tables

_TIME: Final = b"builtin_interfaces/msg/Time"
_TIME_HASH: Final = "b106235e25a4c5ed35098aa0a61a3ee9c9b18d197f398b0e4206cea9acf9c197"
_TIME_FIELDS: Final = [(b"sec", 6), (b"nanosec", 7)]  # with the type ids of REP-2016

# The members of ParameterEvent, a Time, a string and three sequences of Parameter: type id, is it a sequence?
_EVENT_MEMBERS: Final = [(18, False), (16, False), (18, True), (18, True), (18, True)]
_EVENT_SIZE: Final = 104  # of its C struct, whose address nobody has

Find = Callable[[str], CDLL]
"""Opens a library by its name."""


class Unlike(Exception):
    """Something is not as we know it; the text says what."""


def member_layout(find: Find) -> type[tables.Member]:
    """Compare all tables, and return the layout of members, one of two known ones. Raises Unlike."""
    fastrtps = _Library(find, "fastrtps_c")
    _check_message(fastrtps)
    _check_service(fastrtps)
    return _member_layout(_Library(find, "introspection_c"))


class _Library:
    """One kind of type support, with its handles of the packages that rclpy itself uses."""

    def __init__(self, find: Find, kind: str) -> None:
        self._kind = f"rosidl_typesupport_{kind}"
        self._find = find
        self.identifier = c_void_p.in_dll(find(f"lib{self._kind}.so"), f"{self._kind}__identifier").value

    def handle(self, package: str, name: str, what: str = "message") -> int:
        """The address of a handle, such as ("rcl_interfaces", "msg__Parameter")."""
        library = self._find(f"lib{package}__{self._kind}.so")
        symbol = f"{self._kind}__get_{what}_type_support_handle__{package}__{name}"
        try:
            function = library[symbol]
        except AttributeError:
            raise Unlike(f"{library._name} has no {symbol}") from None
        function.restype = c_void_p
        return function() or 0


def _check_message(library: _Library) -> None:
    what = "the type support of a message"
    time = library.handle("builtin_interfaces", "msg__Time")
    identifier, data, _, get_hash, get_description, _ = _words(time, 6)
    _compare(what, identifier, library.identifier)
    namespace, name, *callbacks = _words(data, 7)
    _compare(what, [word != 0 for word in callbacks], [True, True, True, True, False])
    _compare(what, (string_at(namespace), string_at(name)), (b"builtin_interfaces::msg", b"Time"))
    type_hash = tables.TypeHash.from_address(_called(get_hash, time))
    _compare("a type hash", (type_hash.version, bytes(type_hash.value).hex()), (1, _TIME_HASH))
    _check_description(tables.TypeDescription.from_address(_called(get_description, time)))


def _check_description(description: tables.TypeDescription) -> None:
    what = "a type description"
    name, found = description.type_description.type_name, description.type_description.fields
    sizes = (name.size, found.size, description.referenced_type_descriptions.size)
    _compare(what, sizes, (len(_TIME), len(_TIME_FIELDS), 0))
    _compare(what, name.data, _TIME)
    fields = (tables.Field * len(_TIME_FIELDS)).from_address(found.data)
    _compare(what, [field.name.size for field in fields], [len(name) for name, _ in _TIME_FIELDS])
    _compare(what, [(field.name.data, field.type.type_id) for field in fields], _TIME_FIELDS)


def _check_service(library: _Library) -> None:
    what = "the type support of a service"
    service = library.handle("rcl_interfaces", "srv__GetParameters", "service")
    request, response, event = (
        library.handle("rcl_interfaces", f"srv__GetParameters_{part}")
        for part in ("Request", "Response", "Event")
    )
    identifier, data, _, *parts, create, destroy, get_hash, get_description, get_sources = _words(service, 11)
    _compare(what, [identifier, *parts], [library.identifier, request, response, event])
    _compare(what, all((create, destroy, get_hash, get_description, get_sources)), True)
    namespace, name, *ends = _words(data, 4)
    _compare(what, ends, [request, response])
    _compare(what, (string_at(namespace), string_at(name)), (b"rcl_interfaces::srv", b"GetParameters"))


def _member_layout(library: _Library) -> type[tables.Member]:
    what = "the table of a message's members"
    time = library.handle("builtin_interfaces", "msg__Time")
    parameter = library.handle("rcl_interfaces", "msg__Parameter")
    identifier, data = _words(library.handle("rcl_interfaces", "msg__ParameterEvent"), 2)
    _compare(what, identifier, library.identifier)
    table = tables.Members.from_address(data)
    _compare(what, (table.member_count, table.size_of), (len(_EVENT_MEMBERS), _EVENT_SIZE))
    nested = [time, None, parameter, parameter, parameter]
    wanted = [(handle, *kind) for handle, kind in zip(nested, _EVENT_MEMBERS, strict=True)]
    layouts = (tables.Member, tables.MemberWithBuffer)
    for layout in layouts:
        members = (layout * len(wanted)).from_address(table.members)
        if [(member.members, member.type_id, member.is_array) for member in members] == wanted:
            return layout
    raise Unlike(f"a member takes neither {' nor '.join(str(sizeof(layout)) for layout in layouts)} bytes")


def _words(address: int, count: int) -> list[int]:
    if not address:
        raise Unlike("a table is missing")
    return list((c_size_t * count).from_address(address))


def _called(function: int, handle: int) -> int:
    result: int | None = CFUNCTYPE(c_void_p, c_void_p)(function)(handle)
    if not result:
        raise Unlike("a type comes without hash or description")
    return result


def _compare(what: str, found: Any, wanted: Any) -> None:
    if found != wanted:
        raise Unlike(f"{what} has another layout")
