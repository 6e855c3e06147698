"""Programs that only meet at a router: `ROS_STATIC_PEERS` keeps them from finding each other on this machine."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.running.machines import two_machines
from tests.running.sites import Site
from tests.running.terminals import LIMIT

pytest.importorskip("zenoh")

EXAMPLES = Path(__file__).parents[2] / "examples"


def test_programs_meet_at_a_router(site: Site, endpoints: list[str]) -> None:
    router = site.router("--listen", endpoints[0])
    talker, listener = (site.peer(role[0], role, endpoints[0]) for role in ("talk", "listen"))
    for each in (talker, listener):
        each.until("nodes l t")
    listener.until("heard")
    assert listener.end() == 0
    talker.until("nodes t")
    assert router.end() == 130
    assert router.lines[1:] == ["interrupted"]


@pytest.mark.slow
def test_a_router_may_come_late_and_come_back(site: Site, endpoints: list[str]) -> None:
    talker = site.peer("t", "talk", endpoints[0])
    assert endpoints[0] in talker.until("rmw_local")
    talker.until("nodes t")
    first = site.router("--listen", endpoints[0])
    listener = site.peer("l", "listen", endpoints[0])
    talker.until("nodes l t")
    listener.until_all("heard", "nodes l t")  # a message may come before the node
    first.process.kill()
    for each, name in ((talker, "t"), (listener, "l")):
        each.until(f"nodes {name} zenoh")
    site.router("--listen", endpoints[0])
    for each in (talker, listener):
        each.until("nodes l t")
    listener.until("heard")
    assert talker.end() == listener.end() == 0


@pytest.mark.slow
def test_nodes_with_the_configuration_of_rmw_zenoh_meet_programs_at_a_router(
    site: Site, endpoints: list[str]
) -> None:
    gossip = {"target": {"router": ["router", "peer"], "peer": ["router"]}}
    config = site.configuration(
        "session",
        mode="peer",
        connect={"endpoints": endpoints[:1], "exit_on_failure": {"peer": False}},
        listen={"endpoints": ["tcp/localhost:0"]},
        scouting={"multicast": {"enabled": False}, "gossip": gossip},
        timestamping={"enabled": True},
    )
    site.router("--listen", endpoints[0])
    nodes = [site.peer(role[0], role, "", ZENOH_SESSION_CONFIG_URI=config) for role in ("talk", "listen")]
    program = site.peer("p", "listen", endpoints[0])
    for each in (*nodes, program):
        each.until("nodes l p t")
    for each in (nodes[1], program):
        each.until("heard")


@pytest.mark.slow
def test_routers_pass_on_to_each_other(site: Site, endpoints: list[str]) -> None:
    here, there = endpoints
    far = site.router("--listen", there)
    near = site.router("--listen", here, "--connect", there)
    assert near.until("connected") == f"connected to {there}"
    talker, listener = site.peer("t", "talk", here), site.peer("l", "listen", there)
    for each in (talker, listener):
        each.until("nodes l t")
    listener.until("heard")
    far.process.kill()
    assert near.until("connected") == f"connected to 0 of 1 router, still trying: {there}"
    talker.until("nodes t")
    site.router("--listen", there)
    assert near.until("connected") == f"connected to {there}"
    talker.until("nodes l t")
    listener.until("nodes l t")
    listener.until("heard")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("server", "client", "arguments", "says"),
    [
        ("services/server.py", "services/client.py", ("41", "1"), "41 + 1 = 42"),
        (
            "action/fibonacci_server.py",
            "action/fibonacci_client.py",
            ("5",),
            "succeeded: [0, 1, 1, 2, 3, 5]",
        ),
    ],
    ids=["service", "action"],
)
def test_services_and_actions_work_over_two_routers(
    site: Site, endpoints: list[str], server: str, client: str, arguments: tuple[str, ...], says: str
) -> None:
    here, there = endpoints
    site.router("--listen", there)
    site.router("--listen", here, "--connect", there).until("connected")
    serving = site.program(str(EXAMPLES / server), at=there)
    asking = site.program(str(EXAMPLES / client), *arguments, at=here)
    assert asking.process.wait(LIMIT) == 0
    assert any(line.endswith(says) for line in asking.rest())
    assert serving.end() == 0


@pytest.mark.slow
def test_two_machines(site: Site) -> None:
    with two_machines() as (laptop, robot):
        private = site.router(on=robot)
        talker = site.peer("t", "talk", "127.0.0.1", on=robot)
        listener = site.peer("l", "listen", robot.address, on=laptop)
        assert robot.address in listener.until("rmw_local")  # nobody leaves a machine unasked
        talker.until("nodes t")
        assert private.end() == 130
        assert "nodes l t" not in talker.lines
        site.router("--listen", "tcp/[::]:7447", on=robot)
        listener.until("nodes l t")
        listener.until("heard")
        near = site.router("--connect", f"tcp/{robot.address}:7447", on=laptop)
        near.until("connected")
        other = site.peer("o", "listen", "127.0.0.1", on=laptop)
        other.until("nodes l o t")
        other.until("heard")
