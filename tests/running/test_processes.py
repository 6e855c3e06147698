"""Two terminals: programs of one user on one machine find each other, and survive each other.

Each test has a domain of its own, which nobody else on this machine uses.
"""

from __future__ import annotations

import os
import signal
import time
from pathlib import Path

import pytest
from ifgen_pytest.domains import own_domain

from tests.running.terminals import PEER, Machine

pytest.importorskip("zenoh")
if not hasattr(os, "getuid"):
    pytest.skip("processes find each other by sockets that this system lacks", allow_module_level=True)


@pytest.mark.parametrize("first", ["talk", "listen"])
def test_either_may_come_first_and_both_end_clean(machine: Machine, first: str) -> None:
    second = "listen" if first == "talk" else "talk"
    one = machine.run("a", first)
    assert one.until("nodes") == "nodes a alone"
    other = machine.run("b", second)
    for each in (one, other):
        assert each.until("nodes a b") == "nodes a b zenoh"
    (one if first == "listen" else other).until("heard")
    assert _tcp_listeners(one.process.pid) == _tcp_listeners(other.process.pid) == []
    assert other.end() == 0
    one.until("nodes a zenoh")
    assert one.end() == 0
    assert list(machine.folder.iterdir()) == []
    assert all(line.split()[0] in {"nodes", "heard"} for each in (one, other) for line in each.lines)


def test_a_killed_process_is_noticed_and_its_leavings_are_removed(machine: Machine) -> None:
    peers = {name: machine.run(name, "both") for name in "abc"}
    for peer in peers.values():
        peer.until("nodes a b c")
    peers["a"].process.kill()
    killed = time.monotonic()
    for name in "bc":
        peers[name].until("nodes b c", limit=5.0)
    assert time.monotonic() - killed < 5.0  # a connection that is only silent is given up after 10 s
    late = machine.run("d", "both")
    for peer in (peers["b"], peers["c"], late):
        peer.until("nodes b c d")
        peer.until("heard")
    assert {path.name.partition("-")[0] for path in machine.folder.iterdir()} == {
        str(peer.process.pid) for peer in (peers["b"], peers["c"], late)
    }


def test_a_stopped_process_holds_nobody_up_and_goes_on(machine: Machine) -> None:
    talker, listener, other = machine.run("t", "talk"), machine.run("l", "listen"), machine.run("o", "listen")
    for each in (listener, other):
        each.until("heard")
    listener.process.send_signal(signal.SIGSTOP)
    for _ in range(3):
        other.until("heard")
    listener.process.send_signal(signal.SIGCONT)
    for _ in range(3):
        listener.until("heard")
    assert talker.end() == 0


def test_a_fork_of_a_process_leaves_it_alone(machine: Machine) -> None:
    talker, listener = machine.run("t", "fork"), machine.run("l", "listen")
    listener.until("heard")
    for _ in range(2):
        assert talker.until("child") == "child 7"
    for _ in range(2):
        listener.until("heard")
    assert talker.end() == 0
    listener.until("nodes l zenoh")


def test_who_is_off_or_elsewhere_is_not_found(machine: Machine) -> None:
    here = machine.run("here", "both")
    here.until("nodes here")
    off = machine.run("off", "both", ROS_AUTOMATIC_DISCOVERY_RANGE="OFF")
    off.until("heard 20")
    made = [path.name for path in machine.folder.iterdir()]
    assert not any(name.startswith(f"{off.process.pid}-") for name in made)
    with own_domain() as domain:
        elsewhere = machine.run("elsewhere", "both", ROS_DOMAIN_ID=str(domain))
        elsewhere.until("heard 20")
        for each, name in ((here, "here"), (off, "off"), (elsewhere, "elsewhere")):
            assert each.end() == 0
            assert [line for line in each.lines if line.startswith("nodes")] == [f"nodes {name} alone"]


def test_without_zenoh_one_line_says_what_to_install(machine: Machine, tmp_path: Path) -> None:
    (tmp_path / "zenoh.py").write_text("raise ModuleNotFoundError('No module named zenoh', name='zenoh')\n")
    path = os.pathsep.join((str(tmp_path), machine.environment.get("PYTHONPATH", "")))
    content = machine.run("content", "both", PYTHONPATH=path)  # it has all that it needs in its process
    content.until("heard")
    lonely = machine.run("lonely", "talk", PYTHONPATH=path)
    line = lonely.until("rmw_local")
    assert "/count" in line
    assert "install" in line
    assert "runtime" in line
    assert lonely.end() == content.end() == 0
    assert sum(line.startswith("rmw_local") for line in lonely.lines) == 1
    assert not any(line.startswith("rmw_local") for line in content.lines)


@pytest.mark.slow
def test_where_there_are_no_unix_sockets_one_line_says_what_to_do(machine: Machine, tmp_path: Path) -> None:
    program = tmp_path / "without.py"
    program.write_text(
        "import _socket, runpy, sys\ndel _socket.AF_UNIX\nsys.argv = sys.argv[1:]\n"
        "runpy.run_path(sys.argv[0], run_name='__main__')\n"
    )
    lonely = machine.run(PEER, "lonely", "talk", program=str(program))
    line = lonely.until("rmw_local")
    assert "/count" in line
    assert "ROS_AUTOMATIC_DISCOVERY_RANGE=SUBNET" in line
    assert lonely.end() == 0
    assert sum(line.startswith("rmw_local") for line in lonely.lines) == 1


@pytest.mark.slow
def test_ten_processes_find_each_other(machine: Machine) -> None:
    names = [f"p{number}" for number in range(10)]
    peers = [machine.run(name, "both") for name in names]
    for peer in peers:
        peer.until(" ".join(("nodes", *names)))
        peer.until("heard")
    for peer in peers:
        assert peer.end() == 0


def _tcp_listeners(process: int) -> list[str]:
    """The TCP sockets on which a process listens."""
    own = set()
    for descriptor in Path(f"/proc/{process}/fd").glob("*"):
        try:
            own.add(str(descriptor.readlink()))
        except OSError:
            continue
    listening: list[str] = []
    for table in ("tcp", "tcp6"):
        for line in Path(f"/proc/{process}/net/{table}").read_text().splitlines()[1:]:
            fields = line.split()
            if fields[3] == "0A" and f"socket:[{fields[9]}]" in own:
                listening.append(fields[1])
    return listening
