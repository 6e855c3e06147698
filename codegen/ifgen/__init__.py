"""ROS 2 interfaces as typed Python packages: what `ifgen` does, for Python programs.

Everything loads on first use, so that `import ifgen` costs next to nothing.
"""

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ifgen.diagnostics import InterfaceError
    from ifgen.pipeline import check, generate, load, type_hash
    from ifgen.project import activate

__all__ = ["InterfaceError", "activate", "check", "generate", "load", "type_hash"]
__version__ = "0.1.0"

_MODULES = {"InterfaceError": "diagnostics", "activate": "project"}


def __getattr__(name: str) -> object:
    if name not in __all__:
        raise AttributeError(f"module 'ifgen' has no attribute {name!r}")
    return getattr(import_module(f"ifgen.{_MODULES.get(name, 'pipeline')}"), name)


def __dir__() -> list[str]:
    return [*globals(), *__all__]
