"""Facts about the messages of a run, computed once for all messages that contain them."""

from __future__ import annotations

from ifgen.definition.interfaces import Message, Registry
from ifgen.definition.type_description import TypeHashes
from ifgen.definition.types import NamespacedType
from ifgen.generator_py.codec.plan import Extents, plan
from ifgen.generator_py.codec.python.text import CodecText, render


class Facts:
    """Facts about the messages in a registry, besides their definitions."""

    def __init__(self, registry: Registry) -> None:
        self.registry = registry
        self.hashes = TypeHashes(registry)
        self.extents = Extents(registry)

    def codec(self, message: Message) -> CodecText:
        """The codec that the module of a message has."""
        return render(plan(message, self.extents))

    def module_of(self, type_: NamespacedType) -> str:
        """The module that other modules import a message class from."""
        return f"{type_.package}.{type_.folder}"
