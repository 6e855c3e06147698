"""`ifgen nodl observe` and `describe` of its messages: in a file, in a bag and on a topic."""

from __future__ import annotations

from pathlib import Path

import pytest
import yaml

from .test_describe import SLOWLY_ON_REAL, WALKER, ifgen_nodl

OBSERVED = Path(__file__).parent / "observed.py"


@pytest.mark.parametrize("transport", SLOWLY_ON_REAL)
def test_a_message_says_what_is_seen(tmp_path: Path, transport: str) -> None:
    """Described from a message, the node has the document that it has when it runs."""
    running = ifgen_nodl(tmp_path, "describe", "--transport", transport, "--", str(WALKER))
    described = []
    for file in ("node.mcap", "node.yaml"):
        done = ifgen_nodl(tmp_path, "observe", "--transport", transport, "-o", file, "--", str(WALKER))
        assert done.stdout == f"{file}: /robot/walker\n", done.stderr
        described.append(ifgen_nodl(tmp_path, "describe", "--from", file).stdout)
    assert described == [running.stdout] * 2
    [message, _] = yaml.safe_load_all((tmp_path / "node.yaml").read_text())
    [rosout] = [each for each in message["publishers"] if each["name"] == "/rosout"]
    assert rosout["type"]["name"] == "rcl_interfaces/msg/Log"
    assert len(rosout["type"]["hash"]["value"]) == 32
    assert any(rosout["type"]["hash"]["value"])
    [action] = message["action_servers"]
    assert action["send_goal"]["name"] == f"{action['name']}/_action/send_goal"
    assert action["status"]["type"]["name"] == "action_msgs/msg/GoalStatusArray"
    assert not any("/_action/" in each["name"] for each in message["service_servers"])
    assert len(message["parameters"]) == len(message["parameter_values"])


@pytest.mark.parametrize("transport", SLOWLY_ON_REAL)
def test_the_whole_graph(tmp_path: Path, transport: str) -> None:
    done = ifgen_nodl(
        tmp_path, "observe", "--all", "-o", "graph.yaml", "--transport", transport, "--", str(WALKER)
    )
    assert done.returncode == 0, done.stderr
    [graph, _] = yaml.safe_load_all((tmp_path / "graph.yaml").read_text())
    assert [node["name"] for node in graph["nodes"]] == ["/robot/walker"]


@pytest.mark.parametrize("transport", SLOWLY_ON_REAL)
def test_a_message_on_a_topic(tmp_path: Path, transport: str) -> None:
    topic = ("--topic", "/nodl/observed_node")
    done = ifgen_nodl(tmp_path, "describe", *topic, "--transport", transport, "--", str(OBSERVED))
    assert done.stdout == "nodl_version: 2\n", done.stderr
