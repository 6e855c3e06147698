"""The time of a message."""

from typing import Any

from rclpy.clock import ROSClock
from rclpy.logging import LoggingSeverity, get_logger
from rclpy.time import Time

_ADVICE = (
    "without timestamp infomation when 'allow_headerless' is disabled. auto assign ROSTIME to headerless "
    "messages once enabling constructor option of 'allow_headerless'."
)


def stamp_of(msg: Any, allow_headerless: bool, logger: str, start_of_warning: str) -> Time | None:
    """Return the time in the header of a message, or the time now if it has none and that is allowed.

    Otherwise warns, in upstream's words, and returns None. A stamp may be a message or a `Time`.
    """
    if hasattr(msg, "header") and hasattr(msg.header, "stamp"):
        stamp = msg.header.stamp
        return stamp if hasattr(stamp, "nanoseconds") else Time.from_msg(stamp)
    if allow_headerless:
        return ROSClock().now()
    log = get_logger(logger)
    log.set_level(LoggingSeverity.INFO)
    log.warning(f"{start_of_warning} {_ADVICE}")
    return None
