"""The imports of an interface's module, and their spelling."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Final, Literal

from ifgen.generator_py.imports import IN_MESSAGES, Import, Names, statements

_CODEC: Final = "ifgen_runtime.codec"
# Type checkers alone need these: importing typing takes longer than everything else in a message package.
_FOR_TYPE_CHECKERS: Final = {
    "typing",
    "enum",
    "numpy.typing",
    "ifgen_runtime.views",
    "",
}


class Scope(Names):
    """The names that the module of an interface uses.

    `package` is the module's own; `taken` are the classes, fields and constants of the module. If one of them
    has a name that generated code needs, all our names have an underscore at their end in that module: no
    class, field or constant can have such a name.
    """

    def __init__(self, package: str, taken: Iterable[str]) -> None:
        super().__init__(IN_MESSAGES, package)
        self.mark = "" if IN_MESSAGES.keys().isdisjoint(taken) else "_"
        self._codec: set[Import] = set()
        self._nested: set[tuple[str, str]] = set()

    def __call__(self, name: str) -> str:
        """How to spell a name of Python or ifgen_runtime."""
        spelling = name + self.mark
        self.add(IN_MESSAGES[name], name, spelling)
        return spelling

    def nested(self, purpose: Literal["default", "deepcopy"], reference: str) -> str:
        """The function of the module that makes a default message of a class, or copies one deeply."""
        self._nested.add((purpose, reference))
        self(f"{purpose}_of")
        return f"_{purpose}_{reference}"

    def add_for_codec(self, names: Iterable[str], classes: Iterable[Import]) -> None:
        """Import functions that codecs are made of, and classes that only they may need."""
        self._codec.update((_CODEC, name, name) for name in names)
        self._codec.update(classes)

    @property
    def nested_functions(self) -> tuple[str, ...]:
        """The definitions of what `nested` was asked for."""
        return tuple(
            f"_{purpose}_{reference} = {purpose}_of{self.mark}({reference})"
            for purpose, reference in sorted(self._nested)
        )

    @property
    def imports(self) -> tuple[str, ...]:
        """The import statements of run time."""
        return statements(
            (
                (module, name, spelling)
                for module, name, spelling in self._used
                if module not in _FOR_TYPE_CHECKERS and (module != "builtins" or spelling != name)
            ),
            self._own_package,
        )

    @property
    def typing_imports(self) -> tuple[str, ...]:
        """The imports that only type checkers need."""
        return statements((import_ for import_ in self._used if import_[0] in _FOR_TYPE_CHECKERS), indent=4)

    @property
    def lazy_imports(self) -> tuple[str, ...]:
        """The replacements of those of `typing_imports` that are used at run time."""
        return statements(
            ("ifgen_runtime.lazy", name, spelling) for module, name, spelling in self._used if not module
        )

    @property
    def codec_imports(self) -> tuple[str, ...]:
        """The imports that only the codecs need."""
        known = {spelling for _, _, spelling in self._used}
        return statements(
            (import_ for import_ in self._codec if import_[2] not in known), self._own_package, indent=4
        )
