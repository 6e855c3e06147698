"""The messages to users if type support cannot work: each reason in turn, and then that none has lasting effects."""

import ctypes
import os
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from unittest import mock

import rclpy.utilities
from common import rclpy
from humanoid_interfaces.msg import Footstep, FootstepPlan
from humanoid_interfaces.srv import AddTwoInts
from ifgen_runtime.real_rclpy import binding, probe

PAST_THE_END = 1 << 30
make_buffer = ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_void_p, ctypes.c_size_t)
make_cdr = ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_void_p, ctypes.c_int, ctypes.c_int)
jump = ctypes.CFUNCTYPE(ctypes.c_bool, ctypes.c_void_p, ctypes.c_size_t)
position = ctypes.CFUNCTYPE(ctypes.c_void_p, ctypes.c_void_p)


class OtherFastCdr:
    """A libfastcdr with other objects: FastBuffer is {data, size, ...}, Cdr {buffer, position, ...}, in words."""

    def __init__(
        self, *, again: int | None = None, start: int = 0, factor: int = 1, checks: bool = True
    ) -> None:
        def construct_buffer(this: int, data: int, size: int) -> None:
            words = (ctypes.c_size_t * 4).from_address(this)
            words[0], words[1] = data, size
            if again is not None:
                words[2] = words[again]

        def construct_cdr(this: int, buffer: int, endianness: int, version: int) -> None:
            words = (ctypes.c_size_t * 2).from_address(this)
            words[0] = buffer
            words[1] = ctypes.c_size_t.from_address(buffer).value + start

        def jump_ahead(this: int, size: int) -> bool:
            if checks and size > PAST_THE_END:
                return False
            ctypes.c_size_t.from_address(this + 8).value += size * factor
            return True

        def current_position(this: int) -> int:
            return ctypes.c_size_t.from_address(this + 8).value

        self.functions = {
            "fast_buffer": make_buffer(construct_buffer),
            "cdr": make_cdr(construct_cdr),
            "jump": jump(jump_ahead),
            "position": position(current_position),
        }

    def symbols(self) -> dict[str, int]:
        return {
            name: ctypes.cast(function, ctypes.c_void_p).value or 0
            for name, function in self.functions.items()
        }


@contextmanager
def fastcdr(**unlike: int | bool) -> Iterator[None]:
    other = OtherFastCdr(**unlike)
    with mock.patch.object(binding, "_fastcdr_symbols", other.symbols):
        yield


def no_library(name: str) -> None:
    raise OSError(f"{name}: cannot open shared object file")


rclpy.init()
node = rclpy.create_node("refusals")


def attempt(
    name: str, create: Callable[[], object] = lambda: node.create_publisher(Footstep, "step", 1)
) -> None:
    try:
        create()
    except Exception as error:
        print(name, type(error).__name__, error, sep="|")
    else:
        print(name, "works", sep="|")


def forget() -> None:
    """Make the next attempt examine everything again."""
    binding.native.cache_clear()
    binding.member_layout.cache_clear()


with mock.patch.dict(sys.modules, {"ifgen_native": None}):
    attempt("missing")
with mock.patch.object(binding, "_VERSION", 1):
    attempt("release")
with mock.patch.object(rclpy.utilities, "get_rmw_implementation_identifier", lambda: "rmw_cyclonedds_cpp"):
    attempt("cyclonedds")
    attempt("service", lambda: node.create_client(AddTwoInts, "add"))
with mock.patch.dict(os.environ, ROS_DISTRO="humble"):
    attempt("distribution", binding.native)
forget()
with mock.patch.object(probe, "_TIME_HASH", "0" * 64):
    attempt("layout")
with mock.patch.object(ctypes, "CDLL", no_library):
    attempt("library")
with mock.patch.dict(binding._SYMBOLS, jump="_ZN8eprosima7fastcdr3Cdr4leapEm"):
    attempt("symbol")
for name, unlike in {
    "data twice": {"again": 0},
    "size twice": {"again": 1},
    "position": {"start": 4},
    "jump": {"factor": 2},
    "unchecked": {"checks": False},
}.items():
    with fastcdr(**unlike):
        attempt(name)
with fastcdr():
    binding.native()  # the same objects without a fault are accepted: the refusals above have their reason
forget()
attempt("after all")

extension = binding.native()
layout = (("R1 Z", b""),)
tables = (0, 0, 0)
first = 0
try:
    for number in range(5000):
        address, _ = extension.message(object, "many::msg", f"M{number}", 0, *tables, bytes, bytes, layout)
        first = first or address
except RuntimeError:
    print("messages", number, sep="|")
attempt("no slot", lambda: node.create_publisher(FootstepPlan, "plan", 1))
attempt("known", lambda: node.create_publisher(Footstep, "again", 1))
try:
    for number in range(2000):
        extension.service("many::srv", f"S{number}", first, first, first, bytes, *tables)
except RuntimeError as error:
    print("services", number, error, sep="|")
node.destroy_node()
rclpy.shutdown()
