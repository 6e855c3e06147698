"""Finding the libraries of a real ROS 2 in this process, and whether they are ones that we know.

Symbols and layouts decide, not the name of a distribution.

Only ever imported where rclpy is running: its import has already set up the search path of the libraries.
"""

from __future__ import annotations

import ctypes
from functools import cache
from importlib import import_module
from typing import Any, Final

from ifgen_runtime.real_rclpy import probe
from ifgen_runtime.real_rclpy.tables import Member

_FASTRTPS: Final = "rmw_fastrtps_cpp"
# rmw implementations that take rosidl_typesupport_fastrtps_c handles and nothing else of a message's memory.
_SUPPORTED: Final = frozenset({_FASTRTPS, "rmw_fastrtps_dynamic_cpp", "rmw_zenoh_cpp"})

_VERSION: Final = 3  # of the extension's functions for type support; module.c has the same number
_SYMBOLS: Final = {
    "fast_buffer": "_ZN8eprosima7fastcdr10FastBufferC1EPcm",
    "cdr": "_ZN8eprosima7fastcdr3CdrC1ERNS0_10FastBufferENS1_10EndiannessENS0_10CdrVersionE",
    "jump": "_ZN8eprosima7fastcdr3Cdr4jumpEm",
    "position": "_ZN8eprosima7fastcdr3Cdr20get_current_positionEv",
}
_RCUTILS: Final = {
    "set_error": "rcutils_set_error_state",
    "is_error_set": "rcutils_error_is_set",
    "reset_error": "rcutils_reset_error",
}


class TypeSupportError(RuntimeError):
    """Real rclpy cannot be given type support for our classes here; the text says why and what to do."""


@cache
def native() -> Any:
    """The C extension, bound to the libraries of this process.

    Raises TypeSupportError, in one sentence, where the extension is missing or does not fit the middleware.
    """
    try:
        extension = import_module("ifgen_native._native")
    except ImportError as error:
        from ifgen_runtime.installation import add_native  # as slow as all imports that only errors need

        raise TypeSupportError(
            f"real rclpy needs ifgen's type support, which is not installed: run `{add_native()}`;"
            f" Python says: {error}"
        ) from error
    _check_release(extension)
    _check_middleware()
    symbols = _fastcdr_symbols()
    rcutils = _library("librcutils.so")
    symbols |= {key: _address(rcutils, symbol) for key, symbol in _RCUTILS.items()}
    for key, name in (("fastrtps_identifier", "fastrtps"), ("introspection_identifier", "introspection")):
        library = _library(f"librosidl_typesupport_{name}_c.so")
        symbols[key] = ctypes.c_void_p.in_dll(library, f"rosidl_typesupport_{name}_c__identifier").value or 0
    try:
        extension.bind(symbols)
    except ImportError as error:
        raise _unlike(error) from error
    member_layout()
    return extension


@cache
def member_layout() -> type[Member]:
    """The layout of a message's member in this ROS. Raises TypeSupportError if it is unknown."""
    try:
        return probe.member_layout(_library)
    except probe.Unlike as error:
        raise _unlike(error) from error


def _unlike(problem: Exception) -> TypeSupportError:
    from ifgen_runtime.installation import NATIVE  # of use to an error only

    return TypeSupportError(
        f"{NATIVE} {_version(NATIVE)} does not know this ROS 2 ({problem});"
        f" rclpy here is {_version('ros-rclpy', 'rclpy')};"
        f" a newer {NATIVE} may know it, and a package built with colcon does not need it"
    )


def _check_release(extension: Any) -> None:
    if getattr(extension, "TYPE_SUPPORT_VERSION", 1) == _VERSION:
        return
    from ifgen_runtime.installation import NATIVE, RUNTIME  # of use to an error only

    raise TypeSupportError(
        f"{NATIVE} {_version(NATIVE)} and {RUNTIME} {_version(RUNTIME)} do not fit together:"
        " install the same release of both"
    )


def _check_middleware() -> None:
    from rclpy.utilities import get_rmw_implementation_identifier  # only where rclpy is running anyway

    name = get_rmw_implementation_identifier()
    if name not in _SUPPORTED:
        raise TypeSupportError(
            f"{name} reads and writes messages as C structures, which never-compiled classes do not have;"
            f" set RMW_IMPLEMENTATION={_FASTRTPS}, or build the package with colcon"
        )


def _fastcdr_symbols() -> dict[str, int]:
    library = _library("libfastcdr.so.2")
    return {key: _address(library, symbol) for key, symbol in _SYMBOLS.items()}


def _library(name: str) -> ctypes.CDLL:
    try:
        return ctypes.CDLL(name)
    except OSError as error:
        raise TypeSupportError(
            f"{name} of ROS 2 cannot be loaded ({error}); is ROS sourced, or are its wheels installed?"
        ) from error


def _address(library: ctypes.CDLL, symbol: str) -> int:
    try:
        return ctypes.cast(library[symbol], ctypes.c_void_p).value or 0
    except AttributeError as error:
        raise _unlike(AttributeError(f"{library._name} has no {symbol}")) from error


def _version(*distributions: str) -> str:
    from importlib.metadata import PackageNotFoundError, version  # 15 ms, and of use for errors only

    for name in distributions:
        try:
            return version(name)
        except PackageNotFoundError:
            continue
    return "of unknown version"
