"""The ROS domain that the environment names."""

from __future__ import annotations

import os
import re

_UNSET = 2**64 - 1  # stands in rcl for "take the domain from the environment"


def of_environment() -> int:
    """Read ROS_DOMAIN_ID as C reads a number: what follows it does not count, 0x10 is 16, 010 is 8.

    Raises ValueError, with rcl's words, for a text that is no number.
    """
    text = os.environ.get("ROS_DOMAIN_ID", "")
    if not text:
        return 0
    found = re.match(r"\s*([+-]?)(?:0x([0-9a-f]+)|(0[0-7]*)|([0-9]+))", text, re.ASCII | re.IGNORECASE)
    number, end = 0, 0
    if found is not None:
        number = next(
            int(each, base) for each, base in zip(found.groups()[1:], (16, 8, 10), strict=True) if each
        )
        end = found.end()
    if number == 0 and end < len(text):
        raise ValueError("ROS_DOMAIN_ID is not an integral number")
    if number >= 2**64:
        raise ValueError("ROS_DOMAIN_ID is out of range")
    if found is not None and found[1] == "-":
        number = -number % 2**64
    return 0 if number == _UNSET else number
