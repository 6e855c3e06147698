"""numpy's `ndarray` and its dtypes, loaded with the first fixed numeric array and not before."""

from __future__ import annotations

TYPE_CHECKING = False  # typing itself takes longer to import than a message package
if TYPE_CHECKING:
    from typing import Any


class _Numeric:
    """Attributes: `ndarray`, and the dtype object of each dtype name."""

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        import numpy  # takes ten times as long to load as a message package

        value = numpy.ndarray if name == "ndarray" else numpy.dtype(name)
        setattr(self, name, value)
        return value


numeric: Any = _Numeric()
