"""The programs of examples/ in two terminals: they print what they print in one, and Ctrl-C ends them."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.running.terminals import LIMIT, Machine, Terminal

pytest.importorskip("zenoh")

EXAMPLES = Path(__file__).parents[2] / "examples"


def example(machine: Machine, name: str, *words: str) -> Terminal:
    return machine.run(*words, program=str(EXAMPLES / name))


def ends_clean(*programs: Terminal) -> bool:
    return all(each.end() == 0 and "Traceback" not in "".join(each.lines) for each in programs)


@pytest.mark.slow
def test_topics(machine: Machine) -> None:
    listener, talker = (example(machine, f"topics/{name}.py") for name in ("subscriber", "publisher"))
    while not any("I heard 'Hello, robot: " in line for line in listener.lines):
        listener.until("[INFO]")
    assert ends_clean(listener, talker)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("server", "client", "words", "last"),
    [
        ("services/server.py", "services/client.py", ["41", "1"], "41 + 1 = 42"),
        ("action/fibonacci_server.py", "action/fibonacci_client.py", ["5"], "succeeded: [0, 1, 1, 2, 3, 5]"),
        ("action/fibonacci_server.py", "action/fibonacci_client.py", ["40", "2"], "canceled: [0, 1, 1, 2"),
    ],
    ids=["service", "action", "cancelled action"],
)
def test_servers_and_clients(machine: Machine, server: str, client: str, words: list[str], last: str) -> None:
    asking = example(machine, client, *words)  # before there is a server
    serving = example(machine, server)
    assert asking.process.wait(LIMIT) == 0
    assert last in asking.rest()[-1]
    assert ends_clean(serving)
