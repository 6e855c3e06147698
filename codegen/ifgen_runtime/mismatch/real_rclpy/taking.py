"""The senders of messages and requests: rcl knows them, and rclpy keeps them to itself.

A serialized message comes with the gid of its publisher, which the graph has with the hash of its definition.
So the definition of each message is known exactly, whoever has come or left meanwhile.
"""

from __future__ import annotations

import ctypes
from dataclasses import dataclass
from functools import cache
from typing import Any, Final

_OK: Final = 0  # RCL_RET_OK
_GID: Final = 16  # RMW_GID_STORAGE_SIZE
_NUMBERS: Final = (
    "source_timestamp",  # [ns], as is the next
    "received_timestamp",
    "publication_sequence_number",
    "reception_sequence_number",
)
_NO_SEQUENCE: Final = 2**64 - 1  # RMW_MESSAGE_INFO_SEQUENCE_NUMBER_UNSUPPORTED
_PREFIX: Final = 12
_VALUE_AT: Final = 16  # where pybind11 has the pointer to an object's value: after the object's header


class _Allocator(ctypes.Structure):
    """rcutils_allocator_t."""

    _fields_ = [(name, ctypes.c_void_p) for name in ("a", "d", "r", "z", "state")]


class _Serialized(ctypes.Structure):
    """rcutils_uint8_array_t."""

    _fields_ = [
        ("buffer", ctypes.c_void_p),
        ("length", ctypes.c_size_t),
        ("capacity", ctypes.c_size_t),
        ("allocator", _Allocator),
    ]


class _Info(ctypes.Structure):
    """rmw_message_info_t, with room for what a later one may have."""

    _fields_ = [
        *((name, ctypes.c_uint64) for name in _NUMBERS),
        ("identifier", ctypes.c_void_p),
        ("gid", ctypes.c_uint8 * _GID),
        ("later", ctypes.c_uint8 * 128),
    ]


@dataclass(frozen=True, slots=True)
class Taken:
    """A message as it came, with encapsulation; its publisher; and what rclpy tells of it."""

    data: bytes
    gid: bytes
    info: dict[str, int | None]


def take(subscription: int) -> Taken | None:
    """The next message of a subscription, by its address (`rcl_subscription_t`); None if there is none."""
    rcl, rcutils, allocator = _libraries()
    serialized = _Serialized(allocator=allocator)
    info = _Info()
    try:
        taken = rcl.rcl_take_serialized_message(
            subscription, ctypes.byref(serialized), ctypes.byref(info), None
        )
        if taken != _OK:
            rcutils.rcutils_reset_error()
            return None
        data = ctypes.string_at(serialized.buffer, serialized.length)
    finally:
        rcutils.rcutils_uint8_array_fini(ctypes.byref(serialized))
    return Taken(data, bytes(info.gid), _for_rclpy(info))


def key_of(request_id: Any) -> bytes:
    """The client and the number of a request, from rclpy's `rmw_request_id_t`; empty if they cannot be read.

    rclpy shows the number only. In C it comes after the client's gid, so it says whether they were found.
    """
    address = ctypes.c_void_p.from_address(id(request_id) + _VALUE_AT).value
    if not address or ctypes.c_int64.from_address(address + _GID).value != request_id.sequence_number:
        return b""
    return ctypes.string_at(address, _GID + ctypes.sizeof(ctypes.c_int64))


def participant_of(gid: bytes) -> bytes:
    """The participant of DDS, as a rule a process, by the gid of its endpoint or what begins with one."""
    return gid[:_PREFIX]


def _for_rclpy(info: _Info) -> dict[str, int | None]:
    numbers = {name: int(getattr(info, name)) for name in _NUMBERS}
    return {name: None if number == _NO_SEQUENCE else number for name, number in numbers.items()}


@cache
def _libraries() -> tuple[ctypes.CDLL, ctypes.CDLL, _Allocator]:
    rcl, rcutils = ctypes.CDLL("librcl.so"), ctypes.CDLL("librcutils.so")
    rcl.rcl_take_serialized_message.argtypes = [ctypes.c_void_p] * 4
    rcutils.rcutils_get_default_allocator.restype = _Allocator
    return rcl, rcutils, rcutils.rcutils_get_default_allocator()
