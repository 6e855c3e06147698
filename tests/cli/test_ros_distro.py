"""Features that the target ROS 2 does not know are refused, and nothing is written."""

from __future__ import annotations

from pathlib import Path

import pytest
from ifgen.pipeline import stages

from .conftest import Run


@pytest.fixture
def workspace(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    message = tmp_path / "interfaces" / "demo_msgs" / "msg" / "Pose.msg"
    message.parent.mkdir(parents=True)
    message.write_text("@optional float64 speed 0.1\n")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def configure(folder: Path, ros_distro: str | None) -> None:
    said = f'ros_distro = "{ros_distro}"\n' if ros_distro else ""
    (folder / "pyproject.toml").write_text(f'[tool.ifgen]\npaths = ["interfaces"]\n{said}')


@pytest.mark.parametrize(
    ("configured", "sourced", "refused_by"),
    [
        (None, None, None),
        ("jazzy", None, "Jazzy"),
        (None, "kilted", "Kilted"),
        ("lyrical", "jazzy", None),
        ("humble", "lyrical", "Humble"),
        (None, "of_tomorrow", None),
    ],
)
def test_the_configuration_wins_over_what_is_sourced(
    configured: str | None,
    sourced: str | None,
    refused_by: str | None,
    workspace: Path,
    ifgen: Run,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    configure(workspace, configured)
    if sourced:
        monkeypatch.setenv("ROS_DISTRO", sourced)
    for command in (("check",), ("generate",), ("generate", "--check")):
        done = ifgen(*command)
        if refused_by:
            assert done.code == 1
            assert (
                f"error[optional-field]: ROS 2 {refused_by} does not know `@optional`" in done.out + done.err
            )
        else:
            assert done.code == 0, done.err
            assert "warning[optional-field]: `@optional` has no effect yet" in done.out + done.err
    assert (workspace / "generated").exists() == (refused_by is None)


def test_another_target_is_noticed_where_nothing_else_changed(workspace: Path, ifgen: Run) -> None:
    configure(workspace, None)
    assert ifgen("generate").code == 0
    assert ifgen("generate").code == 0
    configure(workspace, "jazzy")
    assert ifgen("generate").code == 1


def test_a_distribution_that_there_is_not(workspace: Path, ifgen: Run) -> None:
    configure(workspace, "jazy")
    done = ifgen("check")
    assert done.code == 2
    assert '\'ros_distro\' in [tool.ifgen] must be "humble", "iron", ' in done.err


def test_the_field_is_an_ordinary_one(workspace: Path) -> None:
    """The type hash is that of the same message without the annotation, as in Lyrical."""
    path = workspace / "interfaces/demo_msgs/msg/Pose.msg"
    optional = stages.load(path).message("demo_msgs/msg/Pose")
    hashed = stages.type_hash("demo_msgs/msg/Pose", path)
    path.write_text("float64 speed 0.1\n")
    plain = stages.load(path).message("demo_msgs/msg/Pose")
    assert optional.fields == plain.fields
    assert hashed == stages.type_hash("demo_msgs/msg/Pose", path)
