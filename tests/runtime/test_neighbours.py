"""Programs on a real ROS, as /proc shows them."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path

import pytest
from ifgen_runtime.domains import neighbours

HEAD = "  sl  local_address rem_address   st tx_queue rx_queue tr tm->when retrnsmt   uid  timeout inode\n"
OWN_PORT = 38672  # of a domain by the rule, but for one half of a participant only


@pytest.fixture
def proc(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setattr(neighbours, "_PROC", tmp_path)
    monkeypatch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
    (tmp_path / "net").mkdir()
    (tmp_path / "net/udp").write_text(HEAD)
    return tmp_path


def start(
    proc: Path,
    number: int,
    ports: Sequence[int],
    libraries: str = "/opt/ros/lib/librcl.so",
    words: str = "talker",
    variables: str = "",
) -> None:
    folder = proc / str(number)
    (folder / "fd").mkdir(parents=True)
    (folder / "maps").write_text(f"7f00-7f01 r-xp 00000000 fe:00 1 {libraries}\n")
    (folder / "cmdline").write_text(words.replace(" ", "\0") + "\0")
    (folder / "environ").write_text(variables)
    with (proc / "net/udp").open("a") as table:
        for index, port in enumerate(ports):
            inode = number * 100 + index
            (folder / "fd" / str(index)).symlink_to(f"socket:[{inode}]")
            table.write(f"1: 00000000:{port:04X} 00000000:0000 07 0:0 0:0 0 0 0 {inode} 2 0 0\n")


def counted() -> dict[int, int]:
    return {domain: nodes.number for domain, nodes in neighbours.on_real_rclpy().items()}


def ports_of(domain: int, participant: int = 0) -> list[int]:
    first = 7400 + 250 * domain + 10 + 2 * participant
    return [first, first + 1, OWN_PORT]


@pytest.mark.parametrize("domain", [0, 1, 71, 101, 232])
def test_ports_tell_the_domain(proc: Path, domain: int) -> None:
    start(proc, 1, ports_of(domain))
    start(proc, 2, ports_of(domain, participant=3), variables="ROS_DOMAIN_ID=9")
    assert counted() == {domain: 2}
    assert str(neighbours.on_real_rclpy()[domain]) == "at least 2 nodes run"


def test_a_program_in_two_domains_is_in_both(proc: Path) -> None:
    start(proc, 1, [*ports_of(3), *ports_of(5)])
    assert counted() == {3: 1, 5: 1}


def test_multicast_without_ports_of_its_own_tells_it_too(proc: Path) -> None:
    start(proc, 1, [7400 + 250 * 4, OWN_PORT])
    assert counted() == {4: 1}


@pytest.mark.parametrize(
    ("variables", "domain"), [("", 0), ("A=1\0ROS_DOMAIN_ID=6\0B=2\0", 6), ("ROS_DOMAIN_ID=x\0", 0)]
)
def test_zenoh_has_other_ports_so_the_environment_tells_the_domain(
    proc: Path, variables: str, domain: int
) -> None:
    start(proc, 1, [], "/lib/librcl.so\n7f01 r-xp 0 0 1 /lib/librmw_zenoh_cpp.so", variables=variables)
    assert counted() == {domain: 1}


def test_others_do_not_count(proc: Path) -> None:
    start(proc, 1, ports_of(1), libraries="/usr/lib/libc.so")
    start(proc, 2, [])  # no node yet
    start(proc, 3, ports_of(1), words="python3 /opt/ros/bin/ros2 topic echo /imu")
    start(proc, 4, ports_of(1), words="python3 -c main() --name ros2-daemon --ros-domain-id 1")
    start(proc, 5, ports_of(1), words="python3 /usr/bin/ifgen topic echo /imu")
    start(proc, os.getpid(), ports_of(1))
    assert counted() == {}
    start(proc, 6, ports_of(1), words="python3 -m ifgen run talker.py")
    assert counted() == {1: 1}


def test_sentences_name_the_way(proc: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(neighbours, "on_local", lambda _=None: {4: neighbours.Nodes(2)})
    start(proc, 1, ports_of(4))
    assert neighbours.elsewhere("rclpy", 4) == "2 nodes run on the local transport: --transport local"
    assert neighbours.elsewhere("local", 4) == "at least 1 node runs on the real rclpy: --transport rclpy"
    assert neighbours.elsewhere("local", 0) == "", "tests switch the other domains off"
    monkeypatch.delenv("IFGEN_OTHER_DOMAINS")
    assert neighbours.elsewhere("local", 0) == (
        "2 nodes run on the local transport in domain 4: ROS_DOMAIN_ID=4; "
        "at least 1 node runs on the real rclpy in domain 4: ROS_DOMAIN_ID=4 and --transport rclpy"
    )
    assert not neighbours.is_elsewhere_only("local", 4)
    assert not neighbours.is_elsewhere_only("rclpy", 0)
    monkeypatch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "OFF")
    assert neighbours.elsewhere("local", 4) == ""


def test_a_system_without_proc_tells_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(neighbours, "_PROC", tmp_path / "none")
    assert counted() == {}
