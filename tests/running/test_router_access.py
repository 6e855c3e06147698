"""Who may connect to a router and publish there: with the files and commands of docs/processes.md."""

from __future__ import annotations

import json
import re
import shutil
import struct
import subprocess
import sys
import threading
import time
from pathlib import Path

import pytest

from tests.running.sites import Site
from tests.running.terminals import Terminal

zenoh = pytest.importorskip("zenoh")

PAGE = Path(__file__).parents[2] / "docs/processes.md"
CAMERA, NOTICES, KEEPER = (
    str(Path(__file__).parent / "peers" / name) for name in ("camera.py", "notices.py", "keeping.py")
)


@pytest.fixture(scope="module")
def authorities(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """Folders with the certificates of two authorities, made as the page says."""
    if shutil.which("openssl") is None:
        pytest.skip("there is no openssl to make certificates")
    making = _blocks("TLS", "sh")[0].replace("DNS:robot", "IP:127.0.0.1")
    folders = {name: tmp_path_factory.mktemp(name) for name in ("ours", "other")}
    for folder in folders.values():
        subprocess.run(["sh", "-ec", making], cwd=folder, check=True, capture_output=True, timeout=60)
    return folders


@pytest.mark.slow
def test_who_has_a_certificate_talks_and_nobody_else(
    site: Site, endpoints: list[str], authorities: dict[str, Path]
) -> None:
    near, far = endpoints[0], endpoints[1].replace("tcp", "tls")
    ours, other = authorities["ours"], authorities["other"]
    site.router("--config", _router_file(site.folder, near, far, ours))
    overrides = {
        "l": _override(ours, ours),
        "stranger": _override(ours, other),
        "nobody": _override(ours, ours).partition(";")[0],
        "distrustful": _override(other, ours),
    }
    peers = {
        name: site.peer(name, "listen" if name == "l" else "talk", far, ZENOH_CONFIG_OVERRIDE=text)
        for name, text in overrides.items()
    }
    peers["t"] = site.peer("t", "talk", near)
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
def test_access_control_keeps_a_topic_from_who_has_a_certificate(
    site: Site, endpoints: list[str], authorities: dict[str, Path]
) -> None:
    near, far = endpoints[0], endpoints[1].replace("tcp", "tls")
    ours = authorities["ours"]
    (rules,) = _blocks("Access control", "json5")
    site.router("--config", _router_file(site.folder, near, far, ours, rules))

    def peer(name: str, role: str, topic: str, at: str) -> Terminal:
        override = _override(ours, ours) if at == far else ""
        remapping = ("--ros-args", "-r", f"count:={topic}")
        return site.peer(name, role, at, *remapping, ZENOH_CONFIG_OVERRIDE=override)

    peers = {
        "any": peer("any", "listen", "cmd", near),
        "command": peer("command", "listen", "cmd_vel", near),
        "far_any": peer("far_any", "talk", "cmd", far),
        "far_command": peer("far_command", "talk", "cmd_vel", far),
    }
    for each in peers.values():
        each.until(f"nodes {' '.join(sorted(peers))}")
    for _ in range(3):
        peers["any"].until("heard")
    assert not any(line.startswith("heard") for line in peers["command"].so_far())
    peer("near_command", "talk", "cmd_vel", near)
    peers["command"].until("heard")


@pytest.mark.slow
def test_notices_of_shared_memory_do_not_pass_by_access_control(
    site: Site, endpoints: list[str], authorities: dict[str, Path]
) -> None:
    near, far = endpoints[0], endpoints[1].replace("tcp", "tls")
    ours = authorities["ours"]
    (rules,) = _blocks("Access control", "json5")
    site.router("--config", _router_file(site.folder, near, far, ours, rules))
    remapping = ("--ros-args", "-r", "count:=cmd_vel")
    robot = site.peer("robot", "listen", near, *remapping)
    watcher = site.program(CAMERA, "watch", "0", "10", at=near)
    site.program(CAMERA, "show", "400000", "0.05", "100000", "1", at=near)
    watcher.until("number")
    robot.until("nodes camera robot watcher")
    settings = json.dumps(_settings(ours, far))
    words = (site.environment["ROS_DOMAIN_ID"], settings, "robot", "camera")
    laptop = subprocess.Popen(
        [sys.executable, NOTICES, *words], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    )
    with laptop:
        assert laptop.stdout is not None
        assert laptop.stdout.readline() == "sent\n"
        site.peer("command", "talk", near, *remapping)
        robot.until("heard")
        laptop.kill()
    assert "heard 0" not in robot.so_far()
    watcher.until("number")


@pytest.mark.slow
def test_answers_about_earlier_messages_do_not_pass_by_access_control(
    site: Site, endpoints: list[str], authorities: dict[str, Path]
) -> None:
    """A transient local subscription asks everybody for them."""
    near, far = endpoints[0], endpoints[1].replace("tcp", "tls")
    ours = authorities["ours"]
    (rules,) = _blocks("Access control", "json5")
    site.router("--config", _router_file(site.folder, near, far, ours, rules))
    config = zenoh.Config()
    for path, value in _settings(ours, far).items():
        config.insert_json5(path, json.dumps(value))
    was_asked = threading.Event()

    def answer(query: zenoh.Query) -> None:
        key, _, rest = str(query.key_expr).partition("/@adv")
        if rest and "/cmd_vel/" in key:
            text = b"laptop:1\0"
            data = b"\0\1\0\0" + len(text).to_bytes(4, "little") + text
            attachment = struct.pack("<qqB16s", 1, time.time_ns(), 16, bytes(16))
            query.reply(key, data, attachment=attachment, timestamp=laptop.new_timestamp())
            was_asked.set()

    with zenoh.open(config) as laptop:
        laptop.declare_queryable("*/cmd_vel/*/*/@adv/**", zenoh.handlers.Callback(answer, indirect=False))
        remapping = ("--ros-args", "-r", "state:=cmd_vel")
        robot = site.program(KEEPER, "robot", *remapping, at=near)
        assert was_asked.wait(30)
        site.program(KEEPER, "command", *remapping, at=near)
        robot.until("state command")
        assert not any(line.startswith("state laptop") for line in robot.so_far())


def _settings(authority: Path, router: str) -> dict[str, object]:
    """Those of a session of Zenoh with the laptop's certificate, which is not ours."""
    override = dict(pair.split("=") for pair in _override(authority, authority).split(";") if "=" in pair)
    settings: dict[str, object] = {path.strip(): json.loads(value) for path, value in override.items()}
    return settings | {"mode": "client", "connect/endpoints": [router]}


def _router_file(folder: Path, near: str, far: str, authority: Path, more: str = "{}") -> str:
    """Write the page's configuration of a router: with these endpoints and certificates, and more settings."""
    (text,) = _blocks("TLS", "json5")
    for documented, used in (("tcp/127.0.0.1:7447", near), ("tls/[::]:7448", far)):
        assert documented in text
        text = text.replace(documented, used)
    path = folder / "router.json5"
    path.write_text(_placed(text, authority).rstrip().removesuffix("}") + more.lstrip().removeprefix("{"))
    return str(path)


def _override(trusted: Path, own: Path) -> str:
    """The page's single values for a program with a certificate."""
    text = _blocks("TLS", "sh")[1].partition("ZENOH_CONFIG_OVERRIDE='")[2].partition("'")[0]
    return _placed(text.replace('"authority.crt"', f'"{trusted}/authority.crt"'), own)


def _placed(text: str, folder: Path) -> str:
    return re.sub(r'"(\w+\.(?:crt|key))"', rf'"{folder}/\1"', text)


def _blocks(title: str, language: str) -> list[str]:
    """The code in a section of the page about processes and machines."""
    text = PAGE.read_text(encoding="utf-8").partition(f"\n### {title}")[2]
    section = re.split(r"^##", text, maxsplit=1, flags=re.MULTILINE)[0]
    return re.findall(rf"^```{language}\n(.*?)^```", section, re.MULTILINE | re.DOTALL)
