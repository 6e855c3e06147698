"""The exceptions that upstream's extension module raises."""

from __future__ import annotations

import builtins


class RCLError(RuntimeError):
    """An operation of the client library failed."""


class RMWError(RuntimeError):
    """An operation of the middleware failed."""


class RCUtilsError(RuntimeError):
    """A helper below the client library failed."""


class InvalidHandle(RuntimeError):
    """An entity was used after its destruction had been requested."""


class NodeNameNonExistentError(RCLError):
    """A graph query named a node that does not exist."""


class UnsupportedEventTypeError(RCLError):
    """The middleware does not know this kind of QoS event."""


class RCLInvalidROSArgsError(RCLError):
    """The ROS arguments could not be parsed."""


class UnknownROSArgsError(RuntimeError):
    """There are unknown ROS arguments; its text is their list."""


class NotImplementedError(builtins.NotImplementedError):
    """Upstream's extension has a separate class for this."""


# The end of several messages: rcl says it wherever an entity would be made in a context that is not up.
CONTEXT_NOT_VALID = (
    "the given context is not valid, either rcl_init() was not called or rcl_shutdown() was called."
)
