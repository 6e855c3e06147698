"""Two machines with a bad network between them, and a router on one of them."""

from __future__ import annotations

import asyncio
import queue
import random
import subprocess
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path

import pytest

from tests.running.machines import Machine, two_far_machines, two_machines
from tests.running.sites import Site

pytest.importorskip("zenoh")
pytestmark = pytest.mark.slow

STEADY = str(Path(__file__).parent / "peers/steady.py")


@pytest.fixture
def machines() -> Iterator[tuple[Machine, Machine]]:
    with two_machines() as made:
        yield made


def on(machine: Machine, *command: str) -> None:
    """Run a command there, or skip the test where that is not allowed."""
    try:
        subprocess.run([*machine.enter, *command], check=True, capture_output=True, text=True, timeout=60)
    except FileNotFoundError as error:
        pytest.skip(str(error))
    except subprocess.CalledProcessError as error:
        pytest.skip(f"{command[0]}: {error.stderr.strip()}")


def test_five_percent_loss_and_a_late_network_lose_nothing(site: Site) -> None:
    """Neither messages nor goals and their results; and state that is kept for late subscriptions keeps coming."""
    with two_far_machines(delay=0.05, loss=0.05) as (laptop, robot):
        site.router("--listen", "tcp/[::]:7447", on=robot)
        for role in ("count", "state"):
            site.program(STEADY, role, at="127.0.0.1", on=robot)
        listener, watching = (
            site.program(STEADY, role, at=robot.address, on=laptop) for role in ("gaps", "watch")
        )
        for number in (100, 200, 300):
            assert listener.until("heard") == f"heard {number} of {number}"
        numbers = [int(watching.until("state").split()[1]) for _ in range(5)]
        assert numbers == sorted(set(numbers))  # of a depth of one: two that come together are one
        assert watching.until("goal") == "goal True"
        assert watching.until("result") == "result 4"


def test_a_partition_that_heals_leaves_nothing_behind(site: Site, machines: tuple[Machine, Machine]) -> None:
    laptop, robot = machines
    site.router("--listen", "tcp/[::]:7447", on=robot)
    state = site.program(STEADY, "state", at="127.0.0.1", on=robot)
    watching = site.program(STEADY, "watch", at=robot.address, on=laptop)
    last = 0
    for _ in range(2):
        state.until("nodes state watch 1")
        watching.until("nodes state watch 1")
        for _ in range(3):
            number = int(watching.until("state").split()[1])
            assert number > last
            last = number
        assert watching.until("result") == "result 4"
        watching.until("goal True")
        on(robot, "ip", "link", "set", "cable", "down")
        state.until("nodes state 1")
        watching.until("result")  # of the goal that was under way: whatever it is, it is said
        on(robot, "ip", "link", "set", "cable", "up")
    watching.until("nodes state watch 1")
    state.until("nodes state watch 1")
    assert watching.until("goal") == "goal True"
    assert watching.until("result") == "result 4"


def test_stalls_and_delays_lose_no_message(site: Site, endpoints: list[str]) -> None:
    """What loss is to a program, since Zenoh uses TCP: 5 % of the pieces arrive 200 ms later, all of them 50 ms."""
    router, relay = endpoints
    site.router("--listen", router)
    with relayed(relay, router, delay=0.05, stall=0.2, share=0.05):
        site.program(STEADY, "count", at=relay)
        listener = site.program(STEADY, "gaps", at=router)
        for number in (100, 200, 300):
            assert listener.until("heard") == f"heard {number} of {number}"


@contextmanager
def relayed(here: str, there: str, *, delay: float, stall: float, share: float) -> Iterator[None]:
    """Pass on what comes to one endpoint to the other, and back, late and in order."""
    draw = random.Random(1)

    async def pass_on(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        loop = asyncio.get_running_loop()
        pieces: asyncio.Queue[tuple[float, bytes]] = asyncio.Queue()

        async def deliver() -> None:
            while True:
                due, piece = await pieces.get()
                await asyncio.sleep(due - loop.time())
                writer.write(piece)

        delivery = asyncio.create_task(deliver())
        while piece := await reader.read(1500):
            late = stall if draw.random() < share else 0.0
            pieces.put_nowait((loop.time() + delay + late, piece))
        delivery.cancel()
        writer.close()

    async def accept(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        others = await asyncio.open_connection(*address(there))
        await asyncio.gather(pass_on(reader, others[1]), pass_on(others[0], writer))

    async def serve() -> None:
        over = asyncio.Event()
        async with await asyncio.start_server(accept, *address(here)):
            ready.put(partial(asyncio.get_running_loop().call_soon_threadsafe, over.set))
            await over.wait()

    ready: queue.Queue[Callable[[], object]] = queue.Queue()
    thread = threading.Thread(target=lambda: asyncio.run(serve()))
    thread.start()
    end = ready.get(timeout=10)
    try:
        yield
    finally:
        end()
        thread.join(10)


def address(endpoint: str) -> tuple[str, int]:
    host, _, port = endpoint.removeprefix("tcp/").rpartition(":")
    return host, int(port)
