"""`ifgen router` on a terminal: what it says, and what it says about mistakes."""

from __future__ import annotations

import signal
import socket
import subprocess
import sys
from pathlib import Path

import pytest
from ifgen.config import installing
from ifgen_tools.running.router import is_on_this_machine, open_router
from ifgen_tools.running.router_configuration import configuration, endpoints_of

from .conftest import Run, write

pytest.importorskip("zenoh")


@pytest.fixture(autouse=True)
def no_configuration(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("ZENOH_ROUTER_CONFIG_URI", raising=False)
    monkeypatch.delenv("ZENOH_CONFIG_OVERRIDE", raising=False)


@pytest.fixture
def port() -> int:
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        number: int = free.getsockname()[1]
        return number


@pytest.mark.parametrize(
    ("number", "code", "word"), [(signal.SIGINT, 130, "interrupted"), (signal.SIGTERM, 143, "terminated")]
)
def test_it_says_where_it_listens_and_ends_cleanly(
    port: int, number: signal.Signals, code: int, word: str
) -> None:
    command = [sys.executable, "-m", "ifgen", "router", "--listen", f"tcp/127.0.0.1:{port}"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as router:
        assert router.stdout is not None
        line = router.stdout.readline()
        router.send_signal(number)
        out, err = router.communicate(timeout=60)
    assert line == f"listening on tcp/127.0.0.1:{port}, for this machine only; Ctrl-C ends it\n"
    assert (out, err, router.returncode) == ("", f"{word}\n", code)


def test_help_fits(ifgen: Run) -> None:
    out = ifgen("router", "--help").out
    assert max(map(len, out.splitlines())) <= 80
    assert "tcp/127.0.0.1:7447" in out


@pytest.mark.parametrize(
    ("endpoint", "advice"),
    [
        ("robot", "write tcp/robot:7447"),
        ("robot:7448", "write tcp/robot:7448"),
        ("10.0.0.5:7448?rel=0", "write tcp/10.0.0.5:7448?rel=0"),
        ("tls/robot", "write tls/robot:7447"),
        ("tcp/[::]", "write tcp/[::]:7447"),
        ("tcp/robot:0", "write tcp/robot:7447"),
        ("tcp/robot:65536", "write tcp/robot:7447"),
        ("foo/robot:7447", "the protocols are tcp, udp"),
        ("tcp/::1:7447", "an IPv6 address is in brackets"),
        ("tcp/robot:" + "9" * 5000, "expected tcp/HOST:PORT"),
        ("", "expected tcp/HOST:PORT"),
    ],
)
@pytest.mark.parametrize("option", ["--listen", "--connect"])
def test_a_wrong_endpoint(ifgen: Run, option: str, endpoint: str, advice: str) -> None:
    done = ifgen("router", option, endpoint)
    assert (done.code, done.out) == (2, "")
    assert done.err.startswith("error[wrong-endpoint]: '")
    assert advice in done.err
    assert len(done.err) < 300


def test_an_option_of_an_endpoint_that_is_wrong(ifgen: Run) -> None:
    done = ifgen("router", "--connect", "tcp/robot:7447?")
    assert done.code == 2
    assert done.err.startswith("error[wrong-endpoint]: --connect: Endpoints must be of the form")


def test_a_port_in_use(ifgen: Run) -> None:
    with socket.socket() as used:
        used.bind(("127.0.0.1", 0))
        used.listen()
        endpoint = f"tcp/127.0.0.1:{used.getsockname()[1]}"
        done = ifgen("router", "--listen", endpoint)
    assert (done.code, done.out) == (1, "")
    assert done.err.startswith(
        f"error[no-router]: a router cannot listen on {endpoint}: address already in use\n  = help: "
    )
    assert "is a router running already?" in done.err


def test_an_address_of_another_machine(ifgen: Run) -> None:
    done = ifgen("router", "--listen", "tcp/192.0.2.1:7447")  # reserved for documentation
    assert done.code == 1
    assert "192.0.2.1:7447: cannot assign requested address" in done.err
    assert "--listen tcp/[::]:7447" in done.err


def test_tls_without_a_key(ifgen: Run, port: int) -> None:
    endpoint = f"tls/127.0.0.1:{port}"
    done = ifgen("router", "--listen", endpoint)
    beginning = f"error[router-configuration]: a router cannot listen on {endpoint}"
    assert (done.code, done.err) == (2, f"{beginning}: Missing TLS private key\n")
    write(Path("router.key"), "no key\n")
    write(Path("router.json5"), "{transport: {link: {tls: {listen_private_key: 'router.key'}}}}")
    done = ifgen("router", "--listen", endpoint, "--config", "router.json5")
    assert done.code == 2
    assert done.err.startswith(beginning)


def test_a_missing_file_of_tls(ifgen: Run, port: int, tmp_path: Path) -> None:
    write(Path("router.json5"), "{transport: {link: {tls: {listen_private_key: 'router.key'}}}}")
    done = ifgen("router", "--listen", f"tls/127.0.0.1:{port}", "--config", "router.json5")
    assert done.code == 2
    missing = "transport/link/tls/listen_private_key: there is no file 'router.key' that can be read"
    assert done.err.startswith(f"error[router-configuration]: {missing}\n")
    assert f"it is looked for in {tmp_path}" in " ".join(done.err.split())


@pytest.mark.parametrize(
    ("text", "message", "place"),
    [
        ("{mode: router", "expected array, boolean, null, number, object, or string", ":1:8"),
        ("{\n  listen: {\n    endpoint: 3}}", "unknown field `endpoint`, expected", ":3:5"),
        ("", "Empty config file", ""),
        ("{connect: {endpoints: ['x']}}", "Endpoints must be of the form <protocol>/<address>", ":1:24"),
    ],
)
@pytest.mark.parametrize("way", ["option", "variable"])
def test_a_broken_file(
    ifgen: Run, monkeypatch: pytest.MonkeyPatch, way: str, text: str, message: str, place: str
) -> None:
    write(Path("router.json5"), text)
    monkeypatch.setenv("ZENOH_ROUTER_CONFIG_URI", "" if way == "option" else "file://router.json5")
    done = ifgen("router", *(["--config", "router.json5"] if way == "option" else []))
    assert (done.code, done.out) == (2, "")
    begin = f"error[router-configuration]: router.json5 is no configuration of Zenoh: {message}"
    assert done.err.startswith(begin)
    assert not place or f" --> router.json5{place}\n" in done.err


def test_a_file_for_programs(ifgen: Run) -> None:
    write(Path("session.json5"), '{mode: "peer"}')
    done = ifgen("router", "--config", "session.json5")
    assert done.code == 2
    assert "session.json5 has the mode 'peer'" in done.err


def test_a_file_that_is_missing(ifgen: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    assert ifgen("router", "--config", "none.json5").code == 2
    monkeypatch.setenv("ZENOH_ROUTER_CONFIG_URI", "none.json5")
    done = ifgen("router")
    assert (done.code, done.err) == (
        2,
        "error[router-configuration]: ZENOH_ROUTER_CONFIG_URI: there is no file none.json5\n",
    )


@pytest.mark.parametrize(
    ("value", "message"),
    [
        ("listen/endpoints", "ZENOH_CONFIG_OVERRIDE has 'listen/endpoints'"),
        ("a/b=1", "ZENOH_CONFIG_OVERRIDE: a/b=1: unknown key"),
        ("listen/endpoints=7", "ZENOH_CONFIG_OVERRIDE: listen/endpoints=7: invalid type: integer"),
        ("mode='client'", "ZENOH_CONFIG_OVERRIDE has the mode 'client'"),
    ],
)
def test_wrong_single_values(ifgen: Run, monkeypatch: pytest.MonkeyPatch, value: str, message: str) -> None:
    monkeypatch.setenv("ZENOH_CONFIG_OVERRIDE", value)
    done = ifgen("router")
    assert (done.code, done.out) == (2, "")
    assert done.err.startswith(f"error[router-configuration]: {message}")


def test_without_zenoh(ifgen: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "zenoh", None)
    done = ifgen("router")
    assert (done.code, done.out) == (2, "")
    assert done.err.startswith("error[no-zenoh]: a router needs Zenoh\n  = help: run `")
    assert installing.add_runtime() in " ".join(done.err.split())


def test_options_come_before_single_values_before_the_file(tmp_path: Path) -> None:
    file = tmp_path / "router.json5"
    override = "connect/endpoints=['tcp/override:2'];scouting/multicast/enabled=true"

    def endpoints(*listen: str, file: Path | None = None, override: str = "") -> list[tuple[str, ...]]:
        made = configuration(listen, (), file, {"ZENOH_CONFIG_OVERRIDE": override})
        return [endpoints_of(made, "listen"), endpoints_of(made, "connect")]

    assert endpoints() == [("tcp/127.0.0.1:7447",), ()]
    assert endpoints("tcp/a:1", "tls/b:2") == [("tcp/a:1", "tls/b:2"), ()]
    file.write_text("{connect: {endpoints: ['tcp/file:1', {strategy: 'oneOf', locators: ['tcp/x:1']}]}}")
    assert endpoints(file=file) == [("tcp/127.0.0.1:7447",), ("tcp/file:1",)]
    file.write_text("{listen: {endpoints: {router: ['tcp/[::]:1']}}, connect: {endpoints: ['tcp/file:1']}}")
    assert endpoints(file=file) == [("tcp/[::]:1",), ("tcp/file:1",)]
    assert endpoints(file=file, override=override) == [("tcp/[::]:1",), ("tcp/override:2",)]
    assert endpoints("tcp/a:1", file=file, override=override) == [("tcp/a:1",), ("tcp/override:2",)]
    made = configuration((), (), file, {"ZENOH_CONFIG_OVERRIDE": override})
    assert made.get_json("scouting/multicast/enabled") == "true"
    assert configuration((), (), file, {}).get_json("scouting/multicast/enabled") == "false"


@pytest.mark.parametrize(
    ("endpoint", "expected"),
    [
        ("tcp/127.0.0.1:7447", True),
        ("tls/localhost:7447", True),
        ("udp/[::1]:7447", True),
        ("unixsock-stream//tmp/router", True),
        ("tcp/[::]:7447", False),
        ("tcp/0.0.0.0:7447", False),
        ("tcp/localhost.example:7447", False),
    ],
)
def test_which_endpoints_only_this_machine_reaches(endpoint: str, expected: bool) -> None:
    assert is_on_this_machine(endpoint) is expected


def test_a_router_that_has_ended_frees_its_port(port: int) -> None:
    for _ in range(3):
        open_router([f"tcp/127.0.0.1:{port}"], variables={}).close()
