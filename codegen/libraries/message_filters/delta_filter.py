"""Filters that pass on what differs from the message before."""

from abc import ABC
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

from message_filters._filters import SimpleFilter

__all__ = [
    "CachedComparisonHandler",
    "ComparisonFilter",
    "ComparisonHandler",
    "DeltaCompare",
    "DeltaFilter",
    "PathDeltaFilter",
    "SimpleFilter",
]


class ComparisonHandler(ABC):  # noqa: B024 - upstream's class, which has no abstract methods either
    """Decides which messages a `ComparisonFilter` passes on."""

    def message_fits(self, message: Any) -> bool:
        """Return whether to pass a message on."""
        raise NotImplementedError

    def do_fields_fit(self, field_a: Any, field_b: Any) -> bool:
        """Return whether the values of a field, before and now, are a reason to pass a message on."""
        raise NotImplementedError


class CachedComparisonHandler(ComparisonHandler):
    """Compares the fields of a message with those of the last one that fitted; the first one always fits.

    A derived class defines `do_fields_fit`, and the functions `_field_getters`, which return a field each.
    """

    _field_getters: Sequence[Callable[[Any], Any]]

    def __init__(self) -> None:
        super().__init__()
        self._message_cache: Any | None = None

    def message_fits(self, message: Any) -> bool:
        """Return whether any field fits, and remember the message if so."""
        before = self._message_cache
        fits = before is None or any(
            self.do_fields_fit(get_field(before), get_field(message)) for get_field in self._field_getters
        )
        if fits:
            self._message_cache = message
        return fits

    def do_fields_fit(self, field_a: Any, field_b: Any) -> bool:
        """Raise NotImplementedError."""
        raise NotImplementedError(
            f"Field comparison not implemented for class: {type(self).__name__}. "
            "Consider implementing do_fields_fit"
        )


class DeltaCompare(CachedComparisonHandler):
    """Lets messages through of which any field has changed. Fields are numbers, texts or truth values."""

    _basic_types = (bool, int, float, str)

    def __init__(self, field_getters: Sequence[Callable[[Any], Any]]) -> None:
        super().__init__()
        self._field_getters = field_getters

    def do_fields_fit(self, field_a: Any, field_b: Any) -> bool:
        """Return whether two values differ. Raises TypeError for those that cannot be compared."""
        if not (isinstance(field_a, self._basic_types) and isinstance(field_b, self._basic_types)):
            raise TypeError(f"Unable to compare fields of types {type(field_a)} and {type(field_b)}")
        return field_a != field_b


class ComparisonFilter(SimpleFilter):
    """Passes on the messages that a handler lets through."""

    def __init__(
        self, comparison_handler: ComparisonHandler, message_filter: SimpleFilter | None = None
    ) -> None:
        super().__init__()
        self._comparison_handler = comparison_handler
        self.incoming_connection: int | None = None
        self.connectInput(message_filter)

    def add(self, message: Any) -> None:
        """Take a message in."""
        if self.message_fits(message):
            self.signalMessage(message)

    def message_fits(self, message: Any) -> bool:
        """Return whether the handler lets a message through."""
        return self._comparison_handler.message_fits(message)

    def connectInput(self, message_filter: SimpleFilter | None) -> None:
        """Take the output of a filter in, unless it is None. Raises RuntimeError for a second one."""
        if self.incoming_connection is not None:
            raise RuntimeError("This instance of ComparisonFilter already has an incoming connection")
        if message_filter is not None:
            self.incoming_connection = message_filter.registerCallback(self.add)


class DeltaFilter(ComparisonFilter):
    """Passes on messages of which any field has changed; `field_getters` return a field each."""

    def __init__(
        self, field_getters: Sequence[Callable[[Any], Any]], message_filter: SimpleFilter | None = None
    ) -> None:
        super().__init__(DeltaCompare(field_getters), message_filter)


class PathDeltaFilter(DeltaFilter):
    """Passes on messages of which any field has changed; fields are named as `pose.position.x`."""

    def __init__(self, field_path_list: Sequence[str], message_filter: SimpleFilter | None = None) -> None:
        getters = [partial(self.get_field_by_path, field_path=path) for path in field_path_list]
        super().__init__(getters, message_filter)

    def get_field_by_path(self, message: Any, field_path: str) -> Any:
        """Return a field of a message, or of one inside it. Raises RuntimeError if there is none."""
        found = message
        for name in field_path.split("."):
            outer, found = found, getattr(found, name, None)
            if found is None:
                raise RuntimeError(
                    f"Unable to access field {name!r} of {type(outer).__name__} (full path: {field_path!r})"
                )
        return found
