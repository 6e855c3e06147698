"""`ifgen check`, `show`, `hash`, and the command line as a whole."""

from __future__ import annotations

import json
from pathlib import Path

import ifgen as toolkit
import pytest

from .conftest import Run, write

STRING = "std_msgs/msg/String RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18\n"


def test_check_finds_nothing(ifgen: Run, demo_msgs: Path) -> None:
    assert ifgen("check", "demo_msgs").out == "3 interfaces in 1 package: no mistakes\n"
    assert ifgen("check", "demo_msgs", "--format", "github").out == ""
    found = json.loads(ifgen("check", "demo_msgs", "--format", "json").out)
    assert found == {"version": 1, "errors": 0, "warnings": 0, "diagnostics": []}


def test_check_finds_mistakes(ifgen: Run, tmp_path: Path) -> None:
    write(tmp_path / "demo_msgs/msg/Pose.msg", "float64 x\n\nfloat64 x\n")
    done = ifgen("check", "demo_msgs")
    assert (done.code, done.err) == (1, "")
    assert done.out.startswith("error[duplicate-field]: ")
    assert " --> demo_msgs/msg/Pose.msg:3:9\n  |\n1 | float64 x\n  |         - " in done.out
    done = ifgen("check", "demo_msgs", "--format", "json")
    [found] = json.loads(done.out)["diagnostics"]
    assert (done.code, found["rule"], len(found["labels"])) == (1, "duplicate-field", 2)
    done = ifgen("check", "demo_msgs", "--format", "github")
    assert done.code == 1
    assert done.out.startswith(
        "::error file=demo_msgs/msg/Pose.msg,line=3,endLine=3,col=9,endColumn=10,title="
    )


def test_check_takes_a_file_that_cannot_be_read(ifgen: Run, tmp_path: Path) -> None:
    (tmp_path / "demo_msgs/msg").mkdir(parents=True)
    (tmp_path / "demo_msgs/msg/A.msg").write_bytes(b"int32 a\n# \xff\n")
    (tmp_path / "demo_msgs/msg/B.msg").mkdir()
    (tmp_path / "demo_msgs/msg/C.msg").symlink_to("nowhere")
    done = ifgen("check", "demo_msgs")
    assert done.code == 1
    assert "demo_msgs/msg/A.msg:2:3" in done.out
    assert "demo_msgs/msg/B.msg: Is a directory" in done.out
    assert "demo_msgs/msg/C.msg: No such file or directory" in done.out


LEG = """\
module leg_msgs { module msg {
  module Leg_Constants { const char LEFT = 76; };
  struct Leg {
    @key @default (value=82) char side;
    @unit (value="rad") double angles[2];
    geometry_msgs::msg::Point foot;
    leg_msgs::srv::Move_It_Request asked;
  };
}; };
"""
MOVE = """\
module leg_msgs { module srv {
  struct Move_It_Request { char which; };
  struct Move_It_Response { boolean done; };
}; };
"""


def test_idl_files_are_as_good_as_others(ifgen: Run, tmp_path: Path) -> None:
    """A package of .idl files, a node that uses them, and all commands that show or write parts of them."""
    write(tmp_path / "leg_msgs/msg/Leg.idl", LEG)
    write(tmp_path / "leg_msgs/srv/Move_It.idl", MOVE)
    write(
        tmp_path / "walker/nodl/walker.nodl.yaml",
        "nodl_version: 2\n"
        "publishers:\n  - {name: /leg, type: leg_msgs/msg/Leg, qos: {history: KEEP_ALL, reliability: RELIABLE}}\n"
        "service_servers:\n  - {name: /move, type: leg_msgs/srv/Move_It}\n",
    )
    assert ifgen("check", ".").out == "2 interfaces and 1 node in 2 packages: no mistakes\n"
    shown = ifgen("show", "leg_msgs/Leg", "-I", ".").out
    assert 'char LEFT="L"\nchar side "R"\nfloat64[2] angles  # [rad]\ngeometry_msgs/Point foot\n' in shown
    assert ifgen("hash", "leg_msgs/srv/Move_It_Request", "-I", ".").out.startswith(
        "leg_msgs/srv/Move_It_Request RIHS01_"
    )
    assert "/leg" in ifgen("graph", ".").out
    done = ifgen("generate", ".", "--with-deps", "-o", "out")
    assert (done.code, done.err) == (0, "")
    for name in ("leg_msgs/msg/_leg.py", "geometry_msgs/msg/_point.py", "walker/walker/walker.py"):
        assert (tmp_path / "out" / name).is_file(), name
    text = (tmp_path / "out/leg_msgs/msg/_leg.py").read_text()
    assert '__encoding__ = "idl"' in text
    assert ifgen("generate", ".", "--with-deps", "-o", "out", "--check").code == 0
    write(tmp_path / "leg_msgs/msg/Leg.idl", LEG.replace("foot;", "foot"))
    done = ifgen("check", ".")
    assert done.code == 1
    assert "error[idl-syntax]: expected `;`, found `leg_msgs`\n --> leg_msgs/msg/Leg.idl:6:35\n" in done.out


def test_show(ifgen: Run, demo_msgs: Path) -> None:
    write(Path("pyproject.toml"), '[tool.ifgen]\npaths = ["demo_msgs"]\n')
    hash_ = toolkit.type_hash("demo_msgs/msg/Pose", "demo_msgs")
    expected = (
        f"demo_msgs/msg/Pose\n{hash_}\n\n"
        "# A pose.\n\n"
        "std_msgs/Header header\n"
        "    builtin_interfaces/Time stamp\n"
        "        int32 sec\n"
        "        uint32 nanosec\n"
        "    string frame_id\n"
        "float64 x 1.5  # [m]\n"
        "float64[3] rest\n"
    )
    assert ifgen("show", "demo_msgs/msg/Pose").out == expected
    assert ifgen("show", "demo_msgs/Pose").out == expected
    found = ifgen("show", "demo_msgs/srv/Move").out
    assert "\nPose goal\n    std_msgs/Header header\n" in found
    assert found.endswith("\n---\nbool ok\n")
    assert ifgen("show", "demo_msgs/srv/Move_Request").out.startswith("demo_msgs/srv/Move_Request\nRIHS01_")


def test_show_spells_every_type(ifgen: Run, tmp_path: Path) -> None:
    lines = [
        "bool A=true",
        "byte B=7",
        'string S="it\'s \\"so\\""',
        "bool a true",
        "byte b 3",
        "uint8[] c [1, 2]",
        'string<=9 d "x"',
        "wstring e",
        "wstring<=3[<=4] f",
        "float32[2] g",
        "Other[] h",
    ]
    write(tmp_path / "p/msg/All.msg", "\n".join(lines) + "\n")
    write(tmp_path / "p/msg/Other.msg", "int8 n\n")
    found = ifgen("show", "p/msg/All", "-I", "p").out.splitlines()
    assert found[3:] == [*lines, "    int8 n"]
    assert ifgen("show", "p/msg/All", "-I", "p").code == 0


def test_show_json_is_the_type_description(ifgen: Run) -> None:
    found = json.loads(ifgen("show", "std_msgs/msg/String", "--json").out)
    assert found == {
        "type_description": {
            "type_name": "std_msgs/msg/String",
            "fields": [
                {
                    "name": "data",
                    "type": {"type_id": 17, "capacity": 0, "string_capacity": 0, "nested_type_name": ""},
                    "default_value": "",
                }
            ],
        },
        "referenced_type_descriptions": [],
    }


def test_hash(ifgen: Run) -> None:
    assert ifgen("hash", "std_msgs/msg/String").out == STRING
    assert ifgen("hash", "std_msgs/String").out == STRING
    names = [line.split()[0] for line in ifgen("hash", "std_srvs", "std_msgs/msg/String").out.splitlines()]
    assert names[:4] == [f"std_srvs/srv/Empty{part}" for part in ("", "_Request", "_Response", "_Event")]
    assert (len(names), names[-1]) == (13, "std_msgs/msg/String")
    assert len(ifgen("hash", "example_interfaces/action/Fibonacci").out.splitlines()) == 13


def test_hash_of_what_can_be_hashed(ifgen: Run, tmp_path: Path) -> None:
    """One interface lacks its dependency, one has a mistake: the others, and parts of these, have hashes."""
    for name, text in {
        "good_msgs/msg/Good.msg": "std_msgs/String text\n",
        "bad_msgs/msg/Fine.msg": "good_msgs/Good good\n",
        "bad_msgs/srv/Half.srv": "int8 a\n---\nnowhere_msgs/A b\n",
        "bad_msgs/msg/Wrong.msg": "int a\n",
        "bad_msgs/msg/Holder.msg": "Wrong[] all\n",
        "bad_msgs/msg/Circle.msg": "Circle[] all\n",
        "bad_msgs/msg/Unread.msg": "\0",
    }.items():
        write(tmp_path / "ws" / name, text)
    (tmp_path / "ws/bad_msgs/msg/Unread.msg").write_bytes(b"# \xff\n")
    done = ifgen("hash", "bad_msgs", "good_msgs", "-I", "ws")
    assert done.code == 1
    hashes = dict(line.split() for line in done.out.splitlines())
    assert set(hashes) == {"bad_msgs/msg/Fine", "bad_msgs/srv/Half_Request", "good_msgs/msg/Good"}
    (tmp_path / "ws/good_msgs").rename(tmp_path / "good_msgs")
    assert hashes["good_msgs/msg/Good"] == toolkit.type_hash("good_msgs/msg/Good", tmp_path / "good_msgs")
    for rule in ("not-utf-8", "unknown-package", "invalid-type", "recursive-type"):
        assert f"error[{rule}]" in done.err
    assert len(ifgen("hash", "-I", "ws").out.splitlines()) > 400
    assert ifgen("hash", "bad_msgs/msg/Wrong", "std_msgs/msg/String", "-I", "ws").out == STRING


def test_an_unknown_package_is_told_with_all_its_advice(ifgen: Run, tmp_path: Path) -> None:
    done = ifgen("show", "geometry_mgs/msg/Pose")
    assert done.code == 2
    assert "did you mean 'geometry_msgs/msg/Pose'? If not, name the folder that it\n" in done.err
    assert "is in with -I DIR" in done.err
    write(tmp_path / "demo/nodl/talker.nodl.yaml", NODE)
    write(tmp_path / "demo/msg/A.msg", "nav_mgs/Path path\n")
    done = ifgen("check", "demo", "--format", "json")
    [found] = json.loads(done.out)["diagnostics"]
    assert len(found["labels"]) == 3
    assert found["help"].startswith("did you mean `nav_msgs`? If not, name the folder that it is in with -I")


NODE = """\
nodl_version: 2
publishers:
  - {name: a, type: nav_mgs/msg/Path, qos: {history: KEEP_ALL, reliability: RELIABLE}}
  - {name: b, type: nav_mgs/msg/Odometry, qos: {history: KEEP_ALL, reliability: RELIABLE}}
"""


def test_hash_of_everything(ifgen: Run, demo_msgs: Path) -> None:
    found = ifgen("hash", "-I", "demo_msgs")
    assert (found.code, found.err) == (0, "")
    hashes = dict(line.split() for line in found.out.splitlines())
    assert len(hashes) > 400
    assert {"demo_msgs/srv/Move_Event", "humanoid_interfaces/action/WalkTo", "std_msgs/msg/String"} <= set(
        hashes
    )
    assert all(h.startswith("RIHS01_") and len(h) == 71 for h in hashes.values())


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("geometry_msg/msg/Pose", "did you mean 'geometry_msgs/msg/Pose'?"),
        ("geometry_msgs/msg/Posse", "did you mean 'geometry_msgs/msg/Pose'"),
        ("geometry_msgs/srv/Pose", "did you mean 'geometry_msgs/msg/Pose'"),
        ("std_srvs/srv/SetBool_Reqest", "did you mean 'std_srvs/srv/SetBool_Request'"),
        ("geometry_msg/msg/Nope", "did you mean the package 'geometry_msgs'?"),
        ("geometry_msg.msg.Pose", "did you mean 'geometry_msgs/msg/Pose'?"),
        ("Posse", "did you mean 'geometry_msgs/msg/Pose'"),
        ("Qqq", "write it as `package/msg/Name`"),
        ("Empty", "std_srvs/srv/Empty"),
        ("qqq", "-I DIR"),
        ("", "-I DIR"),
        ("/", "-I DIR"),
        ("../msg/Pose", "-I DIR"),
    ],
)
def test_names_that_nothing_has(ifgen: Run, name: str, said: str) -> None:
    for command in ("show", "hash"):
        done = ifgen(command, name)
        assert (done.code, done.out) == (2, "")
        assert said in done.err


def test_names_written_otherwise(ifgen: Run) -> None:
    expected, line = ifgen("show", "std_msgs/msg/ColorRGBA").out, ifgen("hash", "std_msgs/msg/ColorRGBA").out
    for name in ("std_msgs/ColorRGBA", "std_msgs.msg.ColorRGBA", "std_msgs::msg::ColorRGBA", "ColorRGBA"):
        assert ifgen("show", name).out == expected
        assert ifgen("hash", name).out == line
    assert ifgen("show", "LoadMap_Request").out == ifgen("show", "nav_msgs/srv/LoadMap_Request").out
    assert ifgen("hash", "LoadMap").out == ifgen("hash", "nav_msgs/srv/LoadMap").out


def test_show_lists_the_types_of_a_package(ifgen: Run) -> None:
    expected = "std_srvs/srv/Empty\nstd_srvs/srv/SetBool\nstd_srvs/srv/Trigger\n"
    assert ifgen("show", "std_srvs").out == ifgen("show", "std_srvs/srv").out == expected
    done = ifgen("show", "std_srvs", "--json")
    assert (done.code, done.out) == (2, "")
    assert done.err.startswith("error: --json describes one TYPE, and std_srvs is a package\n")


def test_help_fits_and_names_every_command(ifgen: Run) -> None:
    assert ifgen("--help").code == 0
    assert ifgen().code == 2
    assert ifgen("--version").out == f"ifgen {toolkit.__version__}\n"
    for command in ("generate", "check", "show", "hash", "run", "doctor"):
        assert command in ifgen().err
        found = ifgen(command, "--help")
        assert found.code == 0
        assert max(map(len, found.out.splitlines())) <= 80
    assert "..." not in ifgen("--help").out.partition("Commands:")[2], "each in one line"
    assert ifgen("gen").code == 2


def test_python_api(demo_msgs: Path) -> None:
    assert toolkit.__all__ == [
        "InputError",
        "InterfaceError",
        "activate",
        "check",
        "generate",
        "load",
        "type_hash",
    ]
    done = toolkit.generate("demo_msgs", output="out")
    assert len(done.written) == 8
    assert toolkit.check("demo_msgs") == ()
    registry = toolkit.load(demo_msgs)
    assert registry.message("demo_msgs/msg/Pose").fields[1].name == "x"
    assert toolkit.type_hash("std_msgs/msg/String") == STRING.split()[1]
    write(demo_msgs / "msg/Pose.msg", "wrong\n")
    [found] = toolkit.check("demo_msgs")
    assert found.primary is not None
    with pytest.raises(
        toolkit.InputError, match=r"demo_msgs/msg/Pose.msg:1:1: error\[missing-name\].*\n  help: "
    ):
        toolkit.load("demo_msgs")
    with pytest.raises(AttributeError):
        toolkit.nonsense  # noqa: B018 - the lookup is what is tested
