"""The context handle: one `init` to `shutdown`, with the arguments and the domain given there."""

from __future__ import annotations

import weakref

from ifgen_runtime import domain_id as domains
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
    try:
        return domains.of_environment()
    except ValueError as error:
        raise RCLError(f"failed to initialize rcl: {error}") from None
