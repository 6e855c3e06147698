"""How far programs reach, by the environment: each variable in processes, on machines that the test makes."""

from __future__ import annotations

import os
import subprocess

import pytest

from tests.running import machines
from tests.running.sites import Site
from tests.running.terminals import PEER, Machine, Terminal

pytest.importorskip("zenoh")

RANGE = "ROS_AUTOMATIC_DISCOVERY_RANGE"


def nodes_seen(peer: Terminal) -> set[str]:
    """The names of all nodes that a peer has ever seen, its own included."""
    seen = (line.split() for line in peer.so_far() if line.startswith("nodes"))
    return {name for words in seen for name in words[1:-1]}


@pytest.mark.slow
def test_the_range_decides_who_is_met_on_two_machines(site: Site) -> None:
    with machines.two_machines() as pair:

        def peer(name: str, on: machines.Machine, reach: str) -> Terminal:
            return site.program(PEER, name, "both", at="", on=on, **{RANGE: reach})

        here, there = pair
        near, far = peer("near", here, "SUBNET"), peer("far", there, "SUBNET")
        local = peer("local", here, "LOCALHOST")
        other = peer("other", there, "SYSTEM_DEFAULT")
        off = peer("off", here, "OFF")
        near.until("nodes far local near")
        far.until("nodes far near other")
        local.until("nodes local near")
        other.until("nodes far other")
        off.until("heard 50")
        local.until("heard")
        assert nodes_seen(near) == {"near", "far", "local"}
        assert nodes_seen(far) == {"near", "far", "other"}
        # They talk to peers that have met peers elsewhere, and stay on their machine all the same.
        assert nodes_seen(local) == {"near", "local"}
        assert nodes_seen(other) == {"far", "other"}
        assert nodes_seen(off) == {"off"}


@pytest.mark.slow
@pytest.mark.skipif(
    not hasattr(os, "getuid") or os.getuid() != 0, reason="another user in a namespace of users"
)
def test_containers_meet_that_share_the_folder_of_sockets(machine: Machine) -> None:
    namespaces = ("unshare", "--user", "--map-root-user", "--net", "--pid", "--fork")
    if subprocess.run([*namespaces, "true"], check=False, capture_output=True).returncode:
        pytest.skip("no namespaces")
    inside, outside = (
        Terminal(machine.environment, PEER, name, "both", before=before)
        for name, before in (("inside", namespaces), ("outside", ()))
    )
    machine.terminals += inside, outside
    for each in (inside, outside):
        each.until("nodes inside outside")
        each.until("heard")


@pytest.mark.slow
def test_a_client_by_its_own_file_waits_for_its_router(site: Site, endpoints: list[str]) -> None:
    settings = site.configuration("own", mode="client", connect={"endpoints": endpoints[:1]})
    talker, listener = (
        site.peer(role[0], role, "", ZENOH_SESSION_CONFIG_URI=f"file://{settings}")
        for role in ("talk", "listen")
    )
    for each in (talker, listener):
        assert f"until there is a router as file://{settings}" in each.until("rmw_local")
        each.until("nodes")  # the program goes on meanwhile
    for _ in range(2):
        router = site.router("--listen", endpoints[0])
        for each in (talker, listener):
            each.until("nodes l t")
        listener.until("heard")
        router.process.kill()
        for each, alone in ((talker, "nodes t zenoh"), (listener, "nodes l zenoh")):
            each.until(alone)
    assert talker.end() == listener.end() == 0
    assert sum(line.startswith("rmw_local") for line in talker.lines) == 1


@pytest.mark.slow
def test_a_file_that_cannot_be_used_is_said_once_and_the_program_goes_on(site: Site) -> None:
    peer = site.peer("p", "both", "", ZENOH_SESSION_CONFIG_URI="missing.json5")
    assert "ZENOH_SESSION_CONFIG_URI: missing.json5 cannot be used" in peer.until("rmw_local")
    peer.until("heard 20")
    assert peer.end() == 0
    assert sum(line.startswith("rmw_local") for line in peer.lines) == 1


@pytest.mark.slow
@pytest.mark.parametrize(("attempts", "lines"), [("3", 3), ("-1", 0)])
def test_a_router_is_looked_for_as_often_as_asked(
    site: Site, endpoints: list[str], attempts: str, lines: int
) -> None:
    settings = site.configuration("own", connect={"endpoints": endpoints[:1], "exit_on_failure": False})
    variables = {"ZENOH_SESSION_CONFIG_URI": settings, "ZENOH_ROUTER_CHECK_ATTEMPTS": attempts}
    peer = site.peer("p", "both", "", **variables)
    peer.until("heard")
    assert sum("no Zenoh router" in line for line in peer.lines) == lines
