"""What follows from the messages of a run and is worked out once for all that hold them."""

from __future__ import annotations

from ifgen.definition.interfaces import Registry
from ifgen.definition.type_description import TypeHashes
from ifgen.generator_py.codec import Extents


class Facts:
    """What is known of the messages in a registry beside their definitions."""

    def __init__(self, registry: Registry) -> None:
        self.registry = registry
        self.hashes = TypeHashes(registry)
        self.extents = Extents(registry)
