"""Filters one after the other, as one filter."""

from dataclasses import dataclass
from typing import Any

from message_filters.simple_filter import SimpleFilter


class Chain(SimpleFilter):
    """Passes messages through filters, the first one added first, and passes on what the last one does."""

    @dataclass
    class FilterInfo:
        """A filter of a chain, and the number of the callback that connects it with the next."""

        message_filter: Any
        connection_callback_index: int

    def __init__(self, message_filter: SimpleFilter | None = None) -> None:
        super().__init__()
        self.incoming_connection: int | None = None
        self._message_filters: dict[int, Chain.FilterInfo] = {}
        if message_filter is not None:
            self.connectInput(message_filter)

    def connectInput(self, message_filter: SimpleFilter) -> None:
        """Take the output of a filter in. Raises RuntimeError for a second one."""
        if self.incoming_connection is not None:
            raise RuntimeError("Already connected")
        self.incoming_connection = message_filter.registerCallback(self.add)

    def add(self, message: Any) -> None:
        """Take a message in."""
        if self._message_filters:
            self._message_filters[0].message_filter.add(message)
        else:
            self.signalMessage(message)

    def addFilter(self, message_filter: Any) -> None:
        """Append a filter with a method `add`."""
        index = len(self._message_filters)
        connection = message_filter.registerCallback(self.signalMessage)
        self._message_filters[index] = Chain.FilterInfo(message_filter, connection)
        if index > 0:
            last = self._message_filters[index - 1]
            last.message_filter.callbacks.pop(last.connection_callback_index)
            last.connection_callback_index = last.message_filter.registerCallback(message_filter.add)

    def getFilter(self, index: int) -> Any:
        """Return a filter by its number, from 0. Raises KeyError if there is none."""
        return self._message_filters[index].message_filter
