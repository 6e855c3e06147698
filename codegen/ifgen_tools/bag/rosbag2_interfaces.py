"""The services by which others control what plays and records: those of rosbag2_interfaces.

Nobody has to generate that package: the classes are made of these definitions when they are needed. Type
hashes are those of ROS, because they depend on names and types only.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any, Final

_DEFINITIONS: Final = {
    "Burst": "uint64 num_messages  # 0: all that are left\n---\nuint64 actually_burst",
    "GetRate": "---\nfloat64 rate",
    "IsPaused": "---\nbool paused",
    "Pause": "---",
    "Play": (
        "builtin_interfaces/Time start_offset\nbuiltin_interfaces/Duration playback_duration\n"
        "builtin_interfaces/Time playback_until_timestamp\n---\nbool success"
    ),
    "PlayNext": "---\nbool success",
    "Resume": "---",
    "Seek": "builtin_interfaces/Time time\n---\nbool success",
    "SetRate": "float64 rate\n---\nbool success",
    "Snapshot": "---\nbool success",
    "SplitBagfile": "---",
    "Stop": "---",
    "TogglePaused": "---",
}


@cache
def service(name: str) -> Any:
    """The class of a service of rosbag2_interfaces."""
    # Most of the command line has no use for classes made at run time.
    from ifgen.dynamic import class_from_text

    return class_from_text(f"rosbag2_interfaces/srv/{name}", _DEFINITIONS[name] + "\n")


def answering(answer: Callable[[Any], dict[str, Any]]) -> Callable[[Any, Any], Any]:
    """The callback of a service whose response has the fields that `answer` returns for a request."""

    def respond(request: Any, response: Any) -> Any:
        for field, value in answer(request).items():
            setattr(response, field, value)
        return response

    return respond
