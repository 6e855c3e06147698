"""The base of events."""


class Event:
    """Something that happened; handlers match and answer it."""

    name = "launch.Event"
