"""The modules that an earlier run has written, and this one would write again."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass

from ifgen.definition.interfaces import Interface
from ifgen.pipeline.freshness.notes import Notes
from ifgen.pipeline.freshness.state import State
from ifgen.reading import manifest
from ifgen.reading.storage import MAX_GENERATED, read_limited


@dataclass(frozen=True, slots=True)
class Modules:
    """The modules of interfaces that an earlier run has written and this one would write again.

    `digests` are the current digests of everything that each interface depends on, by type name.
    """

    notes: Notes
    state: State
    digests: Mapping[str, str]

    def text(self, interface: Interface, path: str) -> str | None:
        """The text of an interface's module at a path in its package; None if that needs work."""
        package = interface.package
        note, found = self.notes.packages.get(package), self.state.packages.get(package)
        if note is None or note.modules.get(interface.type_name) != self.digests[interface.type_name]:
            return None
        record = found.manifest if found is not None else None
        if record is None or record.digest != note.manifest:  # another ifgen may have generated there since
            return None
        with suppress(OSError):
            data = read_limited(self.state.output / package / path, MAX_GENERATED)
            if manifest.digest(data) == record.files.get(path):
                return data.decode()
        return None
