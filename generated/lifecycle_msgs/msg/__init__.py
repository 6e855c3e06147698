"""Messages of lifecycle_msgs.

Classes are loaded when they are first used.
"""

from __future__ import annotations

from ifgen_runtime.lazy import lazy_exports

TYPE_CHECKING = False  # typing itself takes longer to import than this package
if TYPE_CHECKING:
    from lifecycle_msgs.msg._state import State as State
    from lifecycle_msgs.msg._transition import Transition as Transition
    from lifecycle_msgs.msg._transition_description import TransitionDescription as TransitionDescription
    from lifecycle_msgs.msg._transition_event import TransitionEvent as TransitionEvent

__all__ = [
    "State",
    "Transition",
    "TransitionDescription",
    "TransitionEvent",
]

__getattr__, __dir__ = lazy_exports(
    __name__,
    {
        "State": "_state",
        "Transition": "_transition",
        "TransitionDescription": "_transition_description",
        "TransitionEvent": "_transition_event",
    },
)
