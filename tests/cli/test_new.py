"""`ifgen new`: its files are correct as written; it overwrites nothing and says what to do next."""

from __future__ import annotations

from pathlib import Path
from xml.etree import ElementTree

import pytest
from ifgen import check
from ifgen.pipeline import inspection

from .conftest import Run


def test_everything_from_nothing(ifgen: Run, tmp_path: Path) -> None:
    """A new package of interfaces and one of a node pass the check at once, and find each other."""
    for kind in ("msg/Obstacle", "srv/Move", "action/Walk"):
        done = ifgen("new", "interface", f"my_msgs/{kind}", "--colcon")
        assert done.code == 0
        assert f"wrote interfaces/my_msgs/{kind}.{kind.partition('/')[0]}\n" in done.out
        assert done.out.endswith("next: `ifgen generate interfaces/my_msgs`\n")
    assert ifgen("new", "node", "walker").out.splitlines() == [
        "wrote interfaces/walker/package.xml",
        "wrote interfaces/walker/nodl/walker.nodl.yaml",
        "next: `ifgen check interfaces/walker`, or `ifgen generate interfaces/walker`",
    ]
    assert ifgen("new", "node", "my_msgs/talker").out.startswith(
        "wrote interfaces/my_msgs/nodl/talker.nodl.yaml\n"
    )
    assert check("interfaces") == ()
    found = inspection.inspect("interfaces")
    assert (found.packages, found.interfaces, found.nodes) == (2, 3, 2)
    checked = ifgen("check", "interfaces")
    assert checked.out == "3 interfaces and 2 nodes in 2 packages: no mistakes\n"


def test_a_package_of_interfaces_is_one_that_colcon_builds(ifgen: Run, tmp_path: Path) -> None:
    done = ifgen("new", "package", "my_msgs")
    assert done.out == (
        "wrote interfaces/my_msgs/package.xml\nwrote interfaces/my_msgs/CMakeLists.txt\n"
        "next: `ifgen new interface my_msgs/msg/Name`\n"
    )
    package = ElementTree.parse(tmp_path / "interfaces/my_msgs/package.xml").getroot()
    assert package.findtext("name") == "my_msgs"
    assert package.findtext("member_of_group") == "rosidl_interface_packages"
    assert package.findtext("export/build_type") == "ament_cmake"
    assert [e.text for e in package.iter("buildtool_depend")] == ["ament_cmake", "rosidl_default_generators"]
    cmake = (tmp_path / "interfaces/my_msgs/CMakeLists.txt").read_text()
    assert "project(my_msgs)" in cmake
    assert "rosidl_generate_interfaces(${PROJECT_NAME} ${interfaces}" in cmake
    ifgen("new", "interface", "other_msgs/msg/A")
    assert (tmp_path / "interfaces/other_msgs/CMakeLists.txt").read_text() == cmake.replace("my_", "other_")
    idl = "module other_msgs { module msg { struct B { float x; }; }; };"
    (tmp_path / "interfaces/other_msgs/msg/B.idl").write_text(idl)
    ifgen("generate", "interfaces")
    assert (tmp_path / "generated/other_msgs/msg/_b.py").exists(), ".idl files are listed too"
    assert "Unit m." in (tmp_path / "generated/other_msgs/msg/_a.py").read_text(), "of the constant"


def test_files_of_colcon_are_written_where_colcon_is(
    ifgen: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def files(package: str) -> list[str]:
        return sorted(path.name for path in (tmp_path / package).glob("*.*"))

    monkeypatch.delenv("AMENT_PREFIX_PATH", raising=False)
    ifgen("new", "interface", "a_msgs/msg/A", "--in", "plain")
    assert files("plain/a_msgs") == []
    ifgen("new", "interface", "b_msgs/msg/A", "--in", "plain", "--colcon")
    ifgen("new", "interface", "c_msgs/msg/A", "--in", "plain")
    (tmp_path / "ws/install").mkdir(parents=True)
    (tmp_path / "ws/install/.colcon_install_layout").touch()
    ifgen("new", "interface", "a_msgs/msg/A", "--in", "ws/src")
    monkeypatch.setenv("AMENT_PREFIX_PATH", "/opt/ros/jazzy")
    ifgen("new", "interface", "a_msgs/msg/A", "--in", "sourced")
    for package in ("plain/b_msgs", "plain/c_msgs", "ws/src/a_msgs", "sourced/a_msgs"):
        assert files(package) == ["CMakeLists.txt", "package.xml"], package


def test_where_it_goes(ifgen: Run, tmp_path: Path) -> None:
    """A new file goes to the first configured path or to DIR, and to its package if that exists."""
    (tmp_path / "pyproject.toml").write_text('[tool.ifgen]\npaths = ["src/ros"]\n')
    (tmp_path / "src/ros").mkdir(parents=True)
    assert ifgen("new", "package", "demo").out.startswith("wrote src/ros/demo/package.xml")
    assert ifgen("new", "package", "demo", "--in", "other").code == 0
    (tmp_path / "src/ros/deep").mkdir()
    ifgen("new", "interface", "deep_msgs/msg/A", "--in", "src/ros/deep", "--colcon")
    assert ifgen("new", "node", "deep_msgs/n").out.startswith("wrote src/ros/deep/deep_msgs/nodl/n.nodl.yaml")


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["package", "Demo-Msgs"], "did you mean 'demo_msgs'?"),
        (["interface", "Pose"], "such as demo_msgs/msg/Pose"),
        (["interface", "demo_msgs/idl/Pose"], "such as demo_msgs/msg/Pose"),
        (["interface", "demo_msgs/msg/my_pose"], "did you mean demo_msgs/msg/MyPose?"),
        (["interface", "../demo/msg/Pose"], "such as demo_msgs/msg/Pose"),
        (["interface", "2d/msg/Pose"], "a letter first"),
        (["node", "gait-planner"], "did you mean `gait_planner`?"),
        (["node", "Gait-planner/x"], "did you mean 'gait_planner'?"),
        (["node", "lambda"], "rename the file"),
        (["node", "/x"], "a letter first"),
    ],
)
def test_names_are_checked(ifgen: Run, tmp_path: Path, words: list[str], said: str) -> None:
    done = ifgen("new", *words)
    assert done.code == 2
    assert said in " ".join(done.err.split())
    assert list(tmp_path.iterdir()) == []


def test_nothing_is_overwritten(ifgen: Run, tmp_path: Path) -> None:
    ifgen("new", "node", "walker")
    ifgen("new", "interface", "walker/msg/A")
    (tmp_path / "interfaces/walker/nodl/runner.nodl.json").write_text("{}")
    before = {path: path.read_bytes() for path in tmp_path.rglob("*.*") if path.is_file()}
    for words in (
        ["node", "walker"],
        ["interface", "walker/msg/A"],
        ["package", "walker"],
        ["node", "walker/runner"],
    ):
        done = ifgen("new", *words)
        assert (done.code, "exists" in done.err) == (2, True)
    assert {path: path.read_bytes() for path in tmp_path.rglob("*.*") if path.is_file()} == before


def test_a_new_interface_that_is_not_listed_is_told(ifgen: Run, tmp_path: Path) -> None:
    """The CMakeLists.txt of a new package lists all files; other packages' may not."""
    assert "left out" not in ifgen("new", "interface", "demo_msgs/msg/A", "--colcon").out
    assert "left out" not in ifgen("new", "interface", "demo_msgs/msg/B").out
    assert ifgen("check", "interfaces").out == "2 interfaces in 1 package: no mistakes\n"
    cmake = tmp_path / "interfaces/demo_msgs/CMakeLists.txt"
    cmake.write_text("rosidl_generate_interfaces(demo_msgs msg/A.msg msg/B.msg)")
    done = ifgen("new", "interface", "demo_msgs/srv/C")
    assert "add srv/C.srv to the list in interfaces/demo_msgs/CMakeLists.txt, or it is left out\n" in done.out


@pytest.mark.parametrize("name", ["class", "numpy"])
def test_a_package_is_not_called_as_python_needs_it(ifgen: Run, name: str) -> None:
    assert ifgen("new", "package", name).code == 2
    assert ifgen("new", "interface", f"{name}/msg/A").code == 2
    assert not Path("interfaces").exists()
