"""Zenoh's configuration by the environment: what a program reaches, and what is said about mistakes."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

pytest.importorskip("zenoh")

from rmw_local.transports import ConfigurationError
from rmw_local.transports.environment import Environment, read
from rmw_local.transports.zenoh.config import configuration

DOOR = "unixsock-stream//tmp/door"


@pytest.mark.parametrize(
    ("environment", "protocols"),
    [
        (Environment(), ["unixsock-stream"]),
        (Environment(overrides=(("queries_default_timeout", "5000"),)), ["unixsock-stream"]),
        (Environment(overrides=(("connect/endpoints", '["tcp/10.0.0.5:7447"]'),)), None),
        (Environment(subnet=True), None),
        (Environment(routers=("tcp/robot:7447",)), None),
    ],
)
def test_who_does_not_leave_the_machine_has_no_link_that_could(
    environment: Environment, protocols: list[str] | None
) -> None:
    config = configuration(environment, [DOOR], [DOOR])
    assert json.loads(config.get_json("transport/link/protocols")) == protocols


@pytest.mark.parametrize(
    ("environment", "wait"),
    [(Environment(), 20_000), (Environment(subnet=True), 1000)],
    ids=["here", "subnet"],
)
def test_a_publisher_waits_for_a_full_connection_on_this_machine(environment: Environment, wait: int) -> None:
    config = configuration(environment, [DOOR], [])
    place = "transport/link/tx/queue/congestion_control/drop/wait_before_drop"
    assert json.loads(config.get_json(place)) == wait  # [us]; elsewhere as Zenoh has it


def test_a_kernel_without_ipv6_listens_all_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    def listens() -> object:
        return json.loads(configuration(Environment(subnet=True), [DOOR], []).get_json("listen/endpoints"))

    def refuse(family: int) -> object:
        raise OSError(97, f"Address family {family} not supported by protocol")

    assert listens() == [DOOR, "tcp/[::]:0"]
    monkeypatch.setattr("_socket.socket", refuse)
    assert listens() == [DOOR, "tcp/0.0.0.0:0"]


@pytest.mark.parametrize("prefix", ["", "file://"])
def test_a_file_takes_the_place_of_our_configuration(
    prefix: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("own.json5").write_text("{mode: 'client', // of JSON5\n queries_default_timeout: 1234}")
    environment = Environment(config_file=f"{prefix}own.json5", overrides=(("mode", '"peer"'),))
    config = configuration(environment, [DOOR], [DOOR])
    assert config.get_json("queries_default_timeout") == "1234"
    assert config.get_json("mode") == '"peer"'
    assert DOOR not in config.get_json("connect/endpoints")


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (None, "own.json5 cannot be used: No such file"),
        ("{mode: ", "own.json5, line 2, column 1 cannot be used: expected "),
        (
            "{mode: 'clinet'}",
            "own.json5, line 1, column 8 cannot be used: unknown variant `clinet`, expected",
        ),
        ("{modes: 'client'}", "own.json5, line 1, column 2 cannot be used: unknown field `modes`, expected"),
        (
            "{transport: {link: {tls: {connect_certificate: 'mine.crt'}}}}",
            "transport/link/tls/connect_certificate: there is no file 'mine.crt' that can be read in /",
        ),
    ],
)
def test_a_mistake_in_the_file_is_one_line(
    text: str | None, words: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    if text is not None:
        Path("own.json5").write_text(text + "\n")
    with pytest.raises(ConfigurationError) as raised:
        configuration(Environment(config_file="own.json5"), [], [])
    assert words in str(raised.value)
    assert "\n" not in str(raised.value)
    assert ".rs" not in str(raised.value)


@pytest.mark.parametrize(
    ("override", "words"),
    [
        ("mode=client", "mode=client is ignored: expected "),
        ("mode/client=1", "mode/client=1 is ignored: "),
        ('mode="clinet"', "is ignored: unknown variant `clinet`"),
    ],
)
def test_a_mistake_in_an_override_is_one_line(
    override: str, words: str, capsys: pytest.CaptureFixture[str]
) -> None:
    configuration(read({"ZENOH_CONFIG_OVERRIDE": override}), [], [])
    (line,) = capsys.readouterr().err.splitlines()
    assert words in line
    assert ".rs" not in line
