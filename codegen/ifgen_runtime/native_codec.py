"""Which codec runs: the one in C where ifgen-native is installed and fits, the generated functions elsewhere.

Chosen once, when a program first serialises or deserialises something, so that the import of a message
package costs the same either way. `IFGEN_CODEC=python` turns the one in C off. Classes get theirs one by one,
at their own first use. The one in C leaves a message to the generated functions where it meets something
unusual; a class stays with them where its table does not fit.
"""

from __future__ import annotations

import os
import sys
from functools import cache

TYPE_CHECKING = False  # typing itself takes longer to import than a message package
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any, TypeAlias

    from ifgen_runtime.message import Message

    Codec: TypeAlias = tuple[Callable[[Any], bytes], Callable[[bytes], Any]]

VARIABLE = "IFGEN_CODEC"
_ABI = 1  # of the extension's functions and of the text of tables; codec_module.c has the same number
_CHOICES = ("native", "python")


class CodecChoice:
    """The codec of this process."""

    def __init__(self, extension: Any, reason: str) -> None:
        self.extension = extension
        self.reason = reason
        """Why it is this one, in a few words."""
        self.refused: dict[type, str] = {}
        """Classes that stay with their functions in Python although C runs, and why."""

    @property
    def name(self) -> str:
        """`C` or `Python`."""
        return "C" if self.extension else "Python"


@cache
def chosen() -> CodecChoice:
    """The codec that this process uses, and why."""
    wish = os.environ.get(VARIABLE, "")
    if wish == "python":
        return CodecChoice(None, f"{VARIABLE}=python")
    try:
        reason = _opened()
    except ModuleNotFoundError:
        reason = "ifgen_native is not installed"
    except ImportError as error:
        reason = f"ifgen_native cannot be loaded: {error}"
    if wish and wish not in _CHOICES:
        _warn(f"{VARIABLE}={wish!r} is not known and ignored; it can be {' or '.join(_CHOICES)}")
    elif wish and isinstance(reason, str):
        _warn(f"{VARIABLE}={wish}, but the codec in C cannot run: {reason}")
    if isinstance(reason, str):
        return CodecChoice(None, reason)
    return CodecChoice(reason, "ifgen_native is installed")


def _opened() -> Any:
    """The extension, ready for use, or why it cannot be used."""
    if sys.implementation.name != "cpython":
        return f"ifgen_native is for CPython, and this is {sys.implementation.name}"
    if "t" in getattr(sys, "abiflags", ""):
        return "free-threaded builds of Python are not supported"
    from ifgen_native import _native  # only where it runs

    try:
        open_codec = _native.codec_open
    except AttributeError:
        return "this release of ifgen_native has no codec: install a newer one"
    from ifgen_runtime import codec  # where `serialize` comes from, which asks this module first

    return (
        open_codec(_ABI, codec.serialize_in_python, codec.deserialize_in_python, _encode_derived) or _native
    )


def _encode_derived(message: Message) -> bytes:
    """The CDR form of an object of a class derived from a generated one."""
    from ifgen_runtime.message import generated_class  # most programs never come here

    encoded: bytes = vars(generated_class(type(message)))["__codec__"][0](message)
    return encoded


def _warn(text: str) -> None:
    from warnings import warn  # few programs need it

    warn(text, RuntimeWarning, stacklevel=2)


def attached(cls: type[Any]) -> Codec:
    """The functions of a generated class: message -> bytes, and bytes -> message.

    They become `__serialize__` and `__deserialize__` of the class.
    """
    known = vars(cls)
    if "__serialize__" not in known:
        _attach(cls, *known["__codec__"])
    return cls.__serialize__, cls.__deserialize__


def decoder_in_python(cls: type[Any]) -> Callable[..., Any] | None:
    """The generated function that reads messages of a class; None if the class has none."""
    functions = getattr(cls, "__codec__", None)
    return functions[1] if functions else getattr(cls, "__deserialize__", None)


def _attach(
    cls: Any, encode: Callable[[Any], bytes], decode: Callable[[bytes], Any], table: tuple[Any, ...]
) -> None:
    choice = chosen()
    if choice.extension is not None:
        rows, *classes = table
        for called in classes:
            if "__write__" in vars(called):
                attached(called)  # C calls it
        try:
            methods = choice.extension.codec_attach(cls, encode, decode, rows, tuple(classes))
        except (TypeError, ValueError) as error:
            choice.refused[cls] = str(error)
        else:
            cls.__serialize__, cls.__deserialize__ = methods
            return
    cls.__serialize__ = encode
    cls.__deserialize__ = staticmethod(decode)


def attach_methods(cls: Any) -> None:
    """Give a generated class its `__eq__`, `__deepcopy__` and `__copy__`: in C where its codec is in C."""
    if "__codec__" in vars(cls):
        attached(cls)
    extension = chosen().extension
    methods = cls.__generated_eq__, cls.__generated_deepcopy__, cls.__generated_copy__
    if extension is not None and "__codec__" in vars(cls) and cls not in chosen().refused:
        methods = extension.codec_methods(cls)
    cls.__eq__, cls.__deepcopy__, cls.__copy__ = methods
