"""The common methods of handles of the client library."""

from __future__ import annotations

from types import TracebackType
from typing import Protocol


class DestroyableType(Protocol):
    """Something that is used inside a `with` block and destroyed when the last such block ends."""

    def __enter__(self) -> None: ...

    def __exit__(
        self,
        exc_type: type[BaseException] | None,
        exc_val: BaseException | None,
        exctb: TracebackType | None,
    ) -> None: ...

    def destroy_when_not_in_use(self) -> None:
        """Destroy it now, or as soon as no thread is inside a `with` block."""
        ...
