"""Codecs that are made when a class is first serialised or deserialised.

They are half of the work of making a class, and the classes of nested messages seldom need one: the codec of
the outer class has theirs inlined.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from importlib import import_module
from threading import RLock
from typing import Any, Final

from ifgen.definition.interfaces import Message
from ifgen.generator_py.codec.text import CodecText, render
from ifgen.generator_py.messages.classes import Facts
from ifgen.generator_py.names import class_reference, slot_name
from ifgen.wire.plan import plan

_RUNTIME: Final = "ifgen_runtime.codec"
_NONE: Final = CodecText((), (), (), "", "", "pass")
_METHODS: Final = ("__serialize__", "__deserialize__", "__codec__")
_PARTS: Final = ("__write__", "__read__")
"""The functions that only large messages have, for the codecs of messages that contain them."""

_lock: Final = RLock()


class FactsWithoutCodecs(Facts):
    """The facts for modules of classes whose codecs come later."""

    def codec(self, message: Message) -> CodecText:
        """A statement that does nothing."""
        return _NONE


class _Later:
    """An attribute of a class that makes the codec when somebody reads it."""

    def __init__(self, name: str, attach: Any) -> None:
        self._name = name
        self._attach = attach

    def __get__(self, message: object, owner: type[Any]) -> Any:
        self._attach()
        return getattr(owner if message is None else message, self._name)


def attach_later(
    cls: Any,
    nested: tuple[type[Any], ...],
    module: dict[str, Any],
    message: Message,
    facts: Facts,
    made: Mapping[str, type[Any]],
) -> None:
    """Let a class get its codec when that is first used; `nested` are the classes of its fields.

    `made` are the classes of all types that it refers to, by type name.
    """
    cls.__nested__ = nested
    attach = partial(_attach, cls, module, message, facts, made)
    is_large = facts.extents.of(message).is_large
    for name in (*_METHODS, *(_PARTS if is_large else ())):
        setattr(cls, name, _Later(name, attach))


def _is_later(cls: type[Any], name: str) -> bool:
    return isinstance(vars(cls).get(name), _Later)


def _attach(
    cls: type[Any], module: dict[str, Any], message: Message, facts: Facts, made: Mapping[str, type[Any]]
) -> None:
    """Execute the text of the codec in the module of the class."""
    with _lock:
        if not _is_later(cls, "__serialize__"):
            return  # another thread was first
        codec = render(plan(message, facts.extents, slot_name))
        for type_ in codec.class_types:
            nested = made[type_.type_name]
            module[class_reference(type_, message)] = nested
            if _is_later(nested, "__write__"):
                nested.__write__  # noqa: B018 - large ones are called, and have to be complete
        runtime = import_module(_RUNTIME)
        module.update({name: getattr(runtime, name) for name in codec.runtime_imports})
        text = "\n".join((*codec.constants, codec.serialize, codec.deserialize, codec.attachment))
        code = compile(text, f"<ifgen.dynamic codec of {message.type_name}>", "exec", dont_inherit=True)
        for name in (*_METHODS, *_PARTS):
            if _is_later(cls, name):
                delattr(cls, name)
        exec(code, module)
        import_module("ifgen_runtime.codec.choice").attached(cls)
