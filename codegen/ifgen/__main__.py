"""`ifgen`, and `python -m ifgen`, which is the same."""

from __future__ import annotations

import sys


def main() -> int:
    """Run the command line of this process, and return its exit code."""
    try:
        from ifgen.writing.interruption import held  # late: Ctrl-C may come already

        with held(""):
            from ifgen.cli.main import main as run  # late: one that Ctrl-C cuts short may fail in any way
    except KeyboardInterrupt:
        return 130
    return run()


if __name__ == "__main__":
    sys.exit(main())
