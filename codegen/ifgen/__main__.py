"""`ifgen`, and `python -m ifgen`, which is the same."""

from __future__ import annotations

import sys


def main() -> int:
    """Run the command line of this process, and return its exit code."""
    try:
        from ifgen.signals import delay_interrupt  # late: Ctrl-C may come already

        with delay_interrupt(""):
            from ifgen.cli.main import main as run  # late: one that Ctrl-C cuts short may fail in any way
    except KeyboardInterrupt:
        return _code_of_interruption()
    return run()


def _code_of_interruption() -> int:
    """The exit code of Ctrl-C, before the command was known."""
    import signal  # late: most runs are not interrupted

    signal.signal(signal.SIGINT, signal.SIG_IGN)  # it ends now
    from ifgen.cli import plugins  # late: what Ctrl-C cuts short may fail in any way

    return 2 if plugins.ends_as_tools_do(sys.argv[1:]) else 130


if __name__ == "__main__":
    sys.exit(main())
