"""A program that stands for another implementation, and does whatever its first argument says."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import ClassVar

sys.path.insert(0, str(Path(__file__).parent / "bench/programs"))
from conversation import converse

HOW = sys.argv.pop(1)


class Actor:
    """Receives what is sent, as if it had gone round the world."""

    lacks: ClassVar[dict[str, str]] = {"act": "it has no actions"}

    def __init__(self, setting):
        if HOW == "absent":
            raise ModuleNotFoundError("there is none", name="imaginary")
        if HOW == "refuses":
            raise RuntimeError("the router did not\nlet it in")
        self.came = []

    def send(self, topic, value):
        if HOW == "crashes":
            import os
            import signal

            print("a last word", file=sys.stderr, flush=True)
            os.kill(os.getpid(), signal.SIGSEGV)
        if HOW == "hangs":
            sys.stdin.read()
        if HOW == "babbles":
            import os

            os.write(3, b"no json\n")
        self.came.append(value)

    def received(self, topic, count, seconds):
        print("what implementations print is no answer")
        found, self.came = self.came, []
        return found


if HOW == "silent":
    sys.stdin.read()
elif HOW == "no program":
    sys.exit(7)
else:
    converse(Actor, ["pytest", "imaginary"])
