"""Why there is no transform between two frames."""


class TransformException(Exception):
    """The base of all others."""


class ConnectivityException(TransformException):
    """The frames are known, but in different trees."""


class LookupException(TransformException):
    """A frame is not known, or the tree is a loop."""


class ExtrapolationException(TransformException):
    """The time is before or after what is in the buffer."""


class InvalidArgumentException(TransformException):
    """A frame name is empty, or starts with a slash."""


class TimeoutException(TransformException):
    """The answer did not come in time."""
