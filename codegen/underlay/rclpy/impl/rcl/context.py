"""The context handle: one `init` to `shutdown`, with the arguments and the domain given there."""

from __future__ import annotations

import os
import re
import weakref

from rmw_local.graph import Participant

from rclpy.impl import program

from .arguments import Arguments, parse_context_arguments, warn_of_unused
from .destroyable import Destroyable
from .errors import RCLError

# Stands for "take the domain from the environment".
RCL_DEFAULT_DOMAIN_ID = 2**64 - 1


class Context(Destroyable):
    """The owner of nodes. `valid` is a plain attribute for speed: every publish reads it."""

    def __init__(self, args: list[str], domain_id: int) -> None:
        super().__init__()
        if not isinstance(args, list):
            raise TypeError(f"args must be a list of str, such as sys.argv, got {args!r}")
        if not isinstance(domain_id, int) or domain_id < 0:
            raise TypeError(f"domain_id must be an int of 0 or more, got {domain_id!r}")
        self.arguments: Arguments = parse_context_arguments(args)
        self.domain_id = _domain_of_environment() if domain_id == RCL_DEFAULT_DOMAIN_ID else domain_id
        self.participant = Participant(self.domain_id)
        self.program = program.current()
        self.valid = True
        self.program.contexts.add(self)
        if self.arguments.parameters:
            weakref.finalize(self, warn_of_unused, self.arguments)  # at the end of the process at the latest

    def ok(self) -> bool:
        """Whether it was not shut down."""
        return self.valid

    def get_domain_id(self) -> int:
        """The domain, while the context is valid."""
        if not self.valid:
            raise RCLError("Failed to get domain id: error not set")
        return self.domain_id

    def shutdown(self) -> None:
        """Make it invalid; everything that was made in it refuses to work from now on."""
        if not self.valid:
            raise RCLError("failed to shutdown: rcl_shutdown already called on the given context")
        self.invalidate()

    def invalidate(self) -> None:
        """Shut down, unless that has happened. Signal handlers call it too, so it takes no lock."""
        self.valid = False
        self.participant.has_ended = True

    def _on_destroy(self) -> None:
        self.invalidate()


def _domain_of_environment() -> int:
    """Read ROS_DOMAIN_ID as C reads a number: what follows it does not count, 0x10 is 16, 010 is 8."""
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
        raise RCLError("failed to initialize rcl: ROS_DOMAIN_ID is not an integral number")
    if number >= 2**64:
        raise RCLError("failed to initialize rcl: ROS_DOMAIN_ID is out of range")
    if found is not None and found[1] == "-":
        number = -number % 2**64
    return 0 if number == RCL_DEFAULT_DOMAIN_ID else number
