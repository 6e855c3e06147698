"""Programs that only meet at a router: `ROS_STATIC_PEERS` keeps them from finding each other on this machine.

Each test has a domain and ports of its own.
"""

from __future__ import annotations

import json
import os
import re
import shutil
import socket
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest
from ifgen_pytest.domains import own_domain

from tests.running.machines import Machine, two_machines
from tests.running.terminals import LIMIT, Command, Terminal

pytest.importorskip("zenoh")

PAGE = Path(__file__).parents[2] / "docs/processes.md"
EXAMPLES = Path(__file__).parents[2] / "examples"
PEER = str(Path(__file__).parent / "peers/peer.py")


class Site:
    """Routers and programs in one domain."""

    def __init__(self, domain: int, folder: Path) -> None:
        self.folder = folder
        self.environment = {
            **{name: value for name, value in os.environ.items() if not name.startswith("ZENOH_")},
            "ROS_DOMAIN_ID": str(domain),
            "ROS_LOG_DIR": str(folder),
            "PYTHONUNBUFFERED": "1",
            "ZENOH_ROUTER_CHECK_ATTEMPTS": "1",
        }
        self._running: list[Command] = []

    def router(self, *words: str, on: Machine | None = None) -> Command:
        """A router that has said where it listens."""
        router = Command(self.environment, "router", *words, before=on.enter if on else ())
        self._running.append(router)
        router.until("listening on")
        return router

    def program(self, *words: str, at: str, on: Machine | None = None, **more: str) -> Terminal:
        """A program that reaches others at a router only."""
        environment = self.environment | {"ROS_STATIC_PEERS": at} | more
        program = Terminal(environment, *words, before=on.enter if on else ())
        self._running.append(program)
        return program

    def peer(
        self, name: str, role: str, router: str, *words: str, on: Machine | None = None, **more: str
    ) -> Terminal:
        """The peer, as such a program."""
        return self.program(PEER, name, role, *words, at=router, on=on, **more)

    def configuration(self, name: str, **settings: object) -> str:
        """Write a file with a configuration of Zenoh."""
        path = self.folder / f"{name}.json5"
        path.write_text(json.dumps(settings))
        return str(path)

    def close(self) -> None:
        for each in self._running:
            each.process.kill()
            each.process.wait()


@pytest.fixture
def site(tmp_path: Path) -> Iterator[Site]:
    with own_domain() as domain:
        made = Site(domain, tmp_path)
        yield made
        made.close()


@pytest.fixture
def endpoints() -> list[str]:
    """Endpoints that are free."""
    sockets = [socket.socket() for _ in range(2)]
    for each in sockets:
        each.bind(("127.0.0.1", 0))
    numbers = [each.getsockname()[1] for each in sockets]
    for each in sockets:
        each.close()
    return [f"tcp/127.0.0.1:{number}" for number in numbers]


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
    listener.until("heard")
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
def test_who_has_a_certificate_talks_and_nobody_else(site: Site, endpoints: list[str]) -> None:
    if shutil.which("openssl") is None:
        pytest.skip("there is no openssl to make certificates")
    section = _section("TLS")
    making, programs = _blocks(section, "sh")
    folders = {name: site.folder / name for name in ("ours", "other")}
    for folder in folders.values():
        folder.mkdir()
        script = making.replace("DNS:robot", "IP:127.0.0.1")
        subprocess.run(["sh", "-ec", script], cwd=folder, check=True, capture_output=True, timeout=60)

    def placed(text: str, authority: str = "ours", own: str = "ours") -> str:
        """A text of the page, with certificates in these folders."""
        text = text.replace('"authority.crt"', f'"{folders[authority]}/authority.crt"')
        return re.sub(r'"(\w+\.(?:crt|key))"', rf'"{folders[own]}/\1"', text)

    (settings,) = _blocks(section, "json5")
    open_one, endpoint = endpoints[0], endpoints[1].replace("tcp", "tls")
    for documented, free in (("tcp/127.0.0.1:7447", open_one), ("tls/[::]:7448", endpoint)):
        settings = settings.replace(documented, free)
    (site.folder / "router.json5").write_text(placed(settings))
    site.router("--config", str(site.folder / "router.json5"))
    of_program = programs.partition("ZENOH_CONFIG_OVERRIDE='")[2].partition("'")[0]
    overrides = {
        "l": placed(of_program),
        "stranger": placed(of_program, own="other"),
        "nobody": placed(of_program).partition(";")[0],
        "distrustful": placed(of_program, authority="other"),
    }
    peers = {
        name: site.peer(name, "listen" if name == "l" else "talk", endpoint, ZENOH_CONFIG_OVERRIDE=text)
        for name, text in overrides.items()
    }
    peers["t"] = site.peer("t", "talk", open_one)
    for name in ("stranger", "nobody", "distrustful"):
        assert "not reached" in peers[name].until("rmw_local")
        peers[name].until(f"nodes {name}")
    for name in "lt":
        peers[name].until("nodes l t")
    peers["l"].until("heard")
    for name, peer in peers.items():
        assert peer.end() == 0
        seen = {word for line in peer.lines if line.startswith("nodes") for word in line.split()[1:-1]}
        assert seen == ({"l", "t"} if name in "lt" else {name})


@pytest.mark.slow
def test_access_control_keeps_a_topic_back(site: Site, endpoints: list[str]) -> None:
    (text,) = _blocks(_section("Access control"), "json5")
    text = text.replace('cert_common_names: ["laptop"]', "")
    (site.folder / "router.json5").write_text(text)
    site.router("--listen", endpoints[0], "--config", str(site.folder / "router.json5"))
    topics = {"open": "cmd", "closed": "cmd_vel"}
    peers = {
        f"{role}_{name}": site.peer(
            f"{role}_{name}", role, endpoints[0], "--ros-args", "-r", f"count:={topic}"
        )
        for name, topic in topics.items()
        for role in ("talk", "listen")
    }
    for peer in peers.values():
        peer.until(f"nodes {' '.join(sorted(peers))}")
    for _ in range(3):
        peers["listen_open"].until("heard")
    assert peers["listen_closed"].end() == 0
    assert not any(line.startswith("heard") for line in peers["listen_closed"].lines)


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


def _section(title: str) -> str:
    """A section of the page about processes and machines."""
    text = PAGE.read_text(encoding="utf-8").partition(f"\n### {title}")[2]
    return re.split(r"^##", text, maxsplit=1, flags=re.MULTILINE)[0]


def _blocks(section: str, language: str) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```", section, re.MULTILINE | re.DOTALL)
