"""Filters that take messages in and pass them on, cached or synchronised (message_filters 4.11 of Jazzy)."""

from message_filters._filters import Cache, Chain, SimpleFilter, Subscriber
from message_filters._synchronizers import ApproximateTimeSynchronizer, TimeSynchronizer

__all__ = [
    "ApproximateTimeSynchronizer",
    "Cache",
    "Chain",
    "SimpleFilter",
    "Subscriber",
    "TimeSynchronizer",
]
