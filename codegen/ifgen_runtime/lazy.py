"""Imports that wait until something is used: a message package loads in milliseconds, and without numpy."""

from __future__ import annotations

import sys

TYPE_CHECKING = False  # typing itself takes longer to import than a message package
if TYPE_CHECKING:
    from collections.abc import Callable, Mapping
    from types import ModuleType
    from typing import Annotated, Any

    import numpy

    from ifgen_runtime import meaning

    LazyModule = ModuleType
else:
    ModuleType = type(sys)  # types, importlib and what they import take as long as two message classes

    class LazyModule(ModuleType):
        """A module that is imported when something of it is first used, and is ordinary from then on."""

        def __getattr__(self, name: str) -> Any:
            vars(self).update(vars(import_module(self.__name__)))
            self.__class__ = ModuleType
            return getattr(self, name)

    class _Annotated:
        """`typing.Annotated`, imported with the first type hint that is asked for."""

        def __getitem__(self, parts: Any) -> Any:
            from typing import Annotated  # takes longer to import than a message package

            return Annotated[parts]

    numpy = LazyModule("numpy")
    meaning = LazyModule("ifgen_runtime.meaning")
    Annotated = _Annotated()

__all__ = ["Annotated", "LazyModule", "lazy_exports", "meaning", "numeric", "numpy"]


def import_module(name: str) -> ModuleType:
    """Do what `importlib.import_module` does with the full name of a module."""
    __import__(name)
    return sys.modules[name]


class _Numeric:
    """numpy's `ndarray` and the dtype objects by their names, loaded with the first fixed numeric array."""

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        import numpy  # takes ten times as long to load as a message package

        value = numpy.ndarray if name == "ndarray" else numpy.dtype(name)
        setattr(self, name, value)
        return value


numeric: Any = _Numeric()


def lazy_exports(
    package: str, exports: Mapping[str, str]
) -> tuple[Callable[[str], Any], Callable[[], list[str]]]:
    """The `__getattr__` and `__dir__` (PEP 562) of a package whose names live in submodules.

    `exports` maps each public name to its submodule. Submodules can be reached as attributes as well, as if
    the package had imported them.
    """
    submodules = frozenset(exports.values())

    def load(name: str) -> Any:
        if name in exports:
            value = getattr(import_module(f"{package}.{exports[name]}"), name)
        elif name in submodules:
            value = import_module(f"{package}.{name}")
        else:
            raise AttributeError(f"module {package!r} has no attribute {name!r}")
        setattr(sys.modules[package], name, value)
        return value

    def names() -> list[str]:
        special = (name for name in vars(sys.modules[package]) if name.startswith("__"))
        return sorted({*special, *exports, *submodules})

    return load, names
