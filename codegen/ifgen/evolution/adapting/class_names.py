"""The names of message classes in a module of adapters, and the imports that these need."""

from __future__ import annotations

from ifgen.definition.interfaces import Message
from ifgen.evolution.adapting.versions import TwoVersions
from ifgen.generator_py.adapters import short
from ifgen.generator_py.imports import Names
from ifgen.generator_py.names import interface_name

_RUNTIME = "ifgen_runtime.adapters"
_WIDTH = 88
"""The default of ruff: the module is formatted for any project."""


class ClassNames:
    """Names of classes: asking for one has it imported."""

    def __init__(self, versions: TwoVersions) -> None:
        self._versions = versions
        self._names = Names({})
        self._known = {"Adapter": _RUNTIME}

    def of(self, message: Message, *, is_old: bool) -> str:
        """The name of the class of a message, as it was or as it is."""
        facts = self._versions.facts
        interface = interface_name(message)
        part = message.name.removeprefix(interface).lstrip("_")
        frozen = facts.frozen_module(message) if is_old else None
        if frozen is None:
            name = self._spelling(f"{message.package}.{message.folder}", interface, interface)
        else:
            owner = self._versions.old_registry.interface(f"{message.package}/{message.folder}/{interface}")
            spelling = f"{interface}_{short(facts.hashes.of(owner))}"
            name = self._spelling(f".{frozen}", interface, spelling)
        return f"{name}.{part}" if part else name

    def runtime(self, name: str) -> None:
        """Import a name of the runtime's adapters."""
        self._names.add(_RUNTIME, name)

    def _spelling(self, module: str, name: str, spelling: str) -> str:
        if self._known.setdefault(spelling, module) != module:
            spelling = f"{module.replace('.', '_')}_{name}"
        self._names.add(module, name, spelling)
        return spelling

    @property
    def imports(self) -> tuple[str, ...]:
        """The import statements; what is too long for a line has several."""
        return tuple(_broken(line) if len(line) > _WIDTH else line for line in self._names.lines)


def _broken(line: str) -> str:
    if "\n" in line:
        return line
    before, _, names = line.partition(" import ")
    return f"{before} import (\n" + "".join(f"    {name},\n" for name in names.split(", ")) + ")"
