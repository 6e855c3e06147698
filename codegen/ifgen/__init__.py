"""ROS 2 interfaces as typed Python packages: what `ifgen` does, for Python programs.

Everything loads on first use, so that `import ifgen` costs next to nothing.
"""

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ifgen.activation import activate
    from ifgen.diagnostics import InputError
    from ifgen.diagnostics import InputError as InterfaceError
    from ifgen.pipeline.stages import check, generate, load, type_hash

    __version__: str

__all__ = ["InputError", "InterfaceError", "activate", "check", "generate", "load", "type_hash"]

_PLACES = {
    "InputError": ("diagnostics", "InputError"),
    "InterfaceError": ("diagnostics", "InputError"),  # its earlier name: programs catch it
    "__version__": ("resources", "VERSION"),
    "activate": ("activation", "activate"),
}


def __getattr__(name: str) -> object:
    if name not in {*__all__, *_PLACES}:
        raise AttributeError(f"module 'ifgen' has no attribute {name!r}")
    module, original = _PLACES.get(name, ("pipeline.stages", name))
    return getattr(import_module(f"ifgen.{module}"), original)


def __dir__() -> list[str]:
    return [*globals(), *__all__]
