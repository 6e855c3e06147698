"""`ifgen top` in a terminal: keys, sizes, and that the terminal is given back however it ends."""

from __future__ import annotations

import fcntl
import os
import pty
import re
import select
import signal
import struct
import subprocess
import sys
import termios
import time
from collections.abc import Iterator
from functools import partial
from typing import Any

import pytest
from ifgen_pytest.domains import own_domain

LIMIT = 30.0  # [s]
TOP = (sys.executable, "-m", "ifgen", "top", "--transport", "local")
LEFT = b"\x1b[?25h\x1b[?1049l"  # the cursor is shown, and the first screen


class Screen:
    """A terminal of its own, and the program in it."""

    def __init__(self, domain: int, *words: str) -> None:
        self.ours, self.theirs = pty.openpty()
        self.resize(80, 24)
        self.before = termios.tcgetattr(self.theirs)
        self.output = b""
        variables = {
            "TERM": "xterm",
            "NO_COLOR": "1",
            "ROS_DOMAIN_ID": str(domain),
            "TTY": os.ttyname(self.theirs),
        }
        self.process = subprocess.Popen(
            # The one that a leader of a session opens becomes its own, so that Ctrl-C is for it.
            ["sh", "-c", 'exec "$@" <$TTY >$TTY 2>&1', "sh", *TOP, *words],
            env={**os.environ, "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST", **variables},
            start_new_session=True,
            # Whoever started the tests may ignore it, as nohup does. To set a signal takes no lock.
            preexec_fn=partial(signal.signal, signal.SIGHUP, signal.SIG_DFL),  # noqa: PLW1509
        )

    def resize(self, width: int, height: int) -> None:
        fcntl.ioctl(self.theirs, termios.TIOCSWINSZ, struct.pack("HHHH", height, width, 0, 0))

    @property
    def text(self) -> str:
        """The picture that was drawn last."""
        last = self.output.rpartition(b"\x1b[H")[2].decode()
        return re.sub(r"\x1b\[[0-9;?]*[a-zA-Z]", "", last).replace("\r", "")

    def until(self, *words: str) -> None:
        """Wait until all of these are on the screen."""
        end = time.monotonic() + LIMIT
        while not all(word in self.text for word in words):
            assert time.monotonic() < end, self.output[-4000:].decode()
            self.read(0.1)

    def read(self, seconds: float) -> None:
        if select.select([self.ours], [], [], seconds)[0]:
            self.output += os.read(self.ours, 65536)

    def press(self, keys: bytes) -> None:
        os.write(self.ours, keys)

    def end(self) -> int:
        """Its exit code; the terminal is then as it was."""
        end = time.monotonic() + LIMIT
        while self.process.poll() is None:
            assert time.monotonic() < end
            self.read(0.1)
        while select.select([self.ours], [], [], 0)[0]:
            self.read(0)
        assert LEFT in self.output
        assert termios.tcgetattr(self.theirs) == self.before
        return self.process.returncode

    def close(self) -> None:
        self.process.kill()
        self.process.wait(LIMIT)
        os.close(self.ours)
        os.close(self.theirs)


@pytest.fixture
def domain() -> Iterator[int]:
    with own_domain() as number:
        yield number


@pytest.fixture
def screen(domain: int, request: pytest.FixtureRequest) -> Iterator[Screen]:
    made = Screen(domain, *getattr(request, "param", ()))
    yield made
    made.close()


def test_keys_change_what_is_shown_and_ctrl_c_ends_it(screen: Screen) -> None:
    screen.until("[1 topics 0]", "no topics", "q quit")
    screen.press(b"\t")
    screen.until("[2 nodes 0]")
    screen.press(b"?")
    screen.until("a subscription while the topic is on the screen")
    screen.press(b"\x03")
    assert screen.end() == 0
    assert b"Traceback" not in screen.output


@pytest.mark.slow
def test_it_stops_as_ctrl_z_says_and_goes_on(screen: Screen) -> None:
    screen.until("no topics")
    screen.press(b"\x1a")
    while LEFT not in screen.output:
        screen.read(LIMIT)
    assert os.waitpid(screen.process.pid, os.WUNTRACED)[1] & 0xFF == 0x7F
    assert termios.tcgetattr(screen.theirs) == screen.before
    screen.output = b""
    os.kill(screen.process.pid, signal.SIGCONT)
    screen.until("no topics")
    screen.press(b"q")
    assert screen.end() == 0


@pytest.mark.slow
def test_the_size_of_the_terminal_may_change(screen: Screen) -> None:
    screen.until("no topics")
    screen.resize(40, 7)
    os.kill(screen.process.pid, signal.SIGWINCH)
    screen.until("tab table")
    end = time.monotonic() + LIMIT
    while [len(line) for line in screen.text.split("\n")] != [40] * 7:
        assert time.monotonic() < end
        screen.read(0.1)
    screen.press(b"q")
    assert screen.end() == 0


@pytest.mark.slow
def test_the_terminal_is_given_back_on_sigterm(screen: Screen) -> None:
    screen.until("no topics")
    screen.process.terminate()
    assert screen.end() == signal.SIGTERM
    assert b"Traceback" not in screen.output


@pytest.mark.slow
def test_the_terminal_goes_away(screen: Screen) -> None:
    screen.until("no topics")
    os.close(screen.theirs)
    os.close(screen.ours)
    assert screen.process.wait(LIMIT) != 0
    screen.ours, screen.theirs = pty.openpty()  # to be closed


@pytest.mark.slow
def test_without_a_terminal_it_prints_once(domain: int) -> None:
    done = subprocess.run(
        [sys.executable, "-m", "ifgen", "top", "--transport", "local", "--period", "0.2"],
        env={**os.environ, "ROS_DOMAIN_ID": str(domain)},
        capture_output=True,
        text=True,
        timeout=LIMIT,
        check=True,
    )
    assert "no topics" in done.stdout


@pytest.mark.slow
def test_nobody_reads_what_it_prints(domain: int) -> None:
    command = f"{sys.executable} -m ifgen top --json --transport local --period 0.2 | head -1"
    environment: dict[str, Any] = {**os.environ, "ROS_DOMAIN_ID": str(domain)}
    done = subprocess.run(
        ["sh", "-c", command], env=environment, capture_output=True, text=True, timeout=LIMIT, check=True
    )
    assert done.stdout.startswith('{"at"')
    assert done.stderr == ""
