"""The choice between the codec in C, where ifgen_native is installed and fits, and the generated functions.

It is made once, when a program first serialises or deserialises something. So the import of a message package
costs the same either way. `IFGEN_CODEC=python` turns the codec in C off. Each class gets its functions at its
own first use. C leaves a message to the generated functions if it meets something unusual. A class keeps them
if its table does not fit.
"""

from __future__ import annotations

import os
import sys
from array import array
from functools import cache

TYPE_CHECKING = False  # typing itself takes longer to import than a message package
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any, TypeAlias

    from ifgen_runtime.message import Message

    Codec: TypeAlias = tuple[Callable[[Any], bytes], Callable[[bytes], Any]]

VARIABLE = "IFGEN_CODEC"
_ABI = 2  # of the extension's functions and of the text of tables; codec_module.c has the same number
_CHOICES = ("native", "python")


class CodecChoice:
    """The codec of this process."""

    def __init__(self, extension: Any, reason: str) -> None:
        self.extension = extension
        """The extension module, or None if the generated functions run."""
        self.reason = reason
        """The reason for this choice, in a few words."""
        self.refused: dict[type, str] = {}
        """Classes that keep their generated functions although C runs, with the reason."""

    @property
    def name(self) -> str:
        """`C` or `Python`."""
        return "C" if self.extension else "Python"


@cache
def chosen() -> CodecChoice:
    """The codec of this process, and the reason for it."""
    wish = os.environ.get(VARIABLE, "")
    if wish == "python":
        return CodecChoice(None, f"{VARIABLE}=python")
    try:
        extension, reason = _opened()
    except ModuleNotFoundError:
        extension, reason = None, "ifgen_native is not installed"
    except ImportError as error:
        extension, reason = None, f"ifgen_native cannot be loaded: {error}"
    if wish and wish not in _CHOICES:
        _warn(f"{VARIABLE}={wish!r} is not known and ignored; it can be {' or '.join(_CHOICES)}")
    elif wish and extension is None:
        _warn(f"{VARIABLE}={wish}, but the codec in C cannot run: {reason}")
    return CodecChoice(extension, reason)


def _opened() -> tuple[Any, str]:
    """The extension, ready for use, or None, and the reason."""
    if sys.implementation.name != "cpython":
        return None, f"ifgen_native is for CPython, and this is {sys.implementation.name}"
    if "t" in getattr(sys, "abiflags", ""):
        return None, "free-threaded builds of Python are not supported"
    from ifgen_native import _native  # only where it runs

    try:
        open_codec = _native.codec_open
    except AttributeError:
        return None, "this release of ifgen_native has no codec: install a newer one"
    from ifgen_runtime import codec  # where `serialize` comes from, which asks this module first

    refusal = open_codec(_ABI, codec.serialize_in_python, codec.deserialize_in_python, _encode_derived)
    return (None, refusal) if refusal else (_native, "ifgen_native is installed")


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


def packer(cls: type[Any]) -> Callable[[Any], Any]:
    """The `__serialize__` of a generated class, for messages that go to one reader in this process.

    Where C runs, a message with a large array becomes a parcel in place of bytes. `__deserialize__` takes a
    parcel once, and its message gets the arrays in it. `bytes()` makes the bytes of a parcel.
    """
    encode, _ = attached(cls)
    extension = chosen().extension
    if extension is None or "__codec__" not in vars(cls) or cls in chosen().refused:
        return encode
    return extension.codec_packer(cls)  # type: ignore[no-any-return]


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
        except (AttributeError, TypeError, ValueError) as error:
            choice.refused[cls] = str(error)
        else:
            cls.__serialize__, cls.__deserialize__ = methods
            names = (
                cls.__init__.__globals__
            )  # of the module: its constructors and setters make arrays of lists
            if names.get("new_array") is array:
                names["new_array"] = choice.extension.codec_array
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
