"""An .idl file is as good as a .msg file: docs/idl.md is true, and the same definition has the same hash."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import pytest
from ifgen.definition.interfaces import Message, Registry
from ifgen.definition.resolve import resolve
from ifgen.definition.type_description import described_types, type_hash
from ifgen.reading.packages import find_packages
from ifgen.reading.search_path import SearchPath

PAGE = (Path(__file__).parents[2] / "docs" / "idl.md").read_text(encoding="utf-8")


def load(folder: Path, files: dict[str, str]) -> Registry:
    """Write files and resolve their packages."""
    for name, text in files.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text, encoding="utf-8")
    packages = find_packages([folder])
    return resolve(packages, SearchPath(packages))


def test_the_example_of_the_page(tmp_path: Path) -> None:
    """It is read without diagnostics, and means the same as the equivalent .msg file."""
    (text,) = re.findall(r"```idl\n(.*?)```", PAGE, re.DOTALL)
    registry = load(tmp_path, {"demo_msgs/msg/Leg.idl": text})
    assert not registry.warnings
    plain = load(
        tmp_path / "plain",
        {
            "demo_msgs/msg/Leg.msg": "# One leg of a robot.\n# Angles are zero when it stands upright.\n\n"
            "uint8 LEFT=0 # The left one, as seen by the robot.\nuint8 RIGHT=1\n"
            'uint8 side\nfloat64[6] angles # [rad]\nstring<=16 name "leg" # What people call it.\n'
            "geometry_msgs/Point[<=4] contacts\nbuiltin_interfaces/Time stamp\n"
        },
    )
    leg = registry.message("demo_msgs/msg/Leg")
    assert leg.fields[0].annotations[0].name == "key"
    fields = (replace(leg.fields[0], annotations=()), *leg.fields[1:])
    assert replace(leg, fields=fields) == plain.message("demo_msgs/msg/Leg")
    assert type_hash(leg, registry) == type_hash(plain.message("demo_msgs/msg/Leg"), plain)


@pytest.mark.parametrize(
    ("idl", "msg"),
    [
        *(("boolean a", "bool"), ("octet a", "byte"), ("float a", "float32"), ("double a", "float64")),
        *(("short a", "int16"), ("unsigned short a", "uint16"), ("long a", "int32"), ("int8 a", "int8")),
        *(("unsigned long a", "uint32"), ("long long a", "int64"), ("unsigned long long a", "uint64")),
        *(("string a", "string"), ("string<3> a", "string<=3"), ("wstring<3> a", "wstring<=3")),
        *(("double a[3]", "float64[3]"), ("sequence<double> a", "float64[]")),
        *(("sequence<double, 3> a", "float64[<=3]"), ("sequence<wstring<3>> a", "wstring<=3[]")),
        *(
            ("std_msgs::msg::Header a", "std_msgs/Header"),
            ("std_msgs::msg::Header a[2]", "std_msgs/Header[2]"),
        ),
    ],
)
def test_the_same_type_has_the_same_hash(tmp_path: Path, idl: str, msg: str) -> None:
    text = f"module demo_msgs {{ module msg {{ struct A {{ {idl}; }}; }}; }};"
    one = load(tmp_path / "idl", {"demo_msgs/msg/A.idl": text})
    two = load(tmp_path / "msg", {"demo_msgs/msg/A.msg": f"{msg} a\n"})
    name = "demo_msgs/msg/A"
    assert one.message(name) == two.message(name)
    assert type_hash(one.message(name), one) == type_hash(two.message(name), two)


def test_parts_of_services_and_actions_are_types(tmp_path: Path) -> None:
    """A part loads the file of its whole, in either form; its class has the usual name."""
    registry = load(
        tmp_path,
        {
            "demo_msgs/msg/Log.idl": "module demo_msgs { module msg { struct Log {"
            " demo_msgs::srv::Ask_It_Request a; std_srvs::srv::SetBool_Response b;"
            " demo_msgs::action::Go_Goal c; demo_msgs::action::Go_SendGoal_Request d; }; }; };",
            "demo_msgs/srv/Ask_It.idl": "module demo_msgs { module srv {"
            " struct Ask_It_Request { long a; }; struct Ask_It_Response { long a; }; }; };",
            "demo_msgs/action/Go.action": "---\n---\n",
        },
    )
    log = registry.message("demo_msgs/msg/Log")
    assert [described.type_name for described in described_types(log)] == ["demo_msgs/msg/Log"]
    assert registry.interface("std_srvs/srv/SetBool")
    assert type_hash(log, registry).startswith("RIHS01_")


@pytest.mark.parametrize("form", ["msg", "idl"])
def test_either_form_is_a_dependency(tmp_path: Path, form: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """An installed package may have .idl files, .msg files, or both: then the .idl was made from the .msg."""
    monkeypatch.setenv("AMENT_PREFIX_PATH", str(tmp_path / "prefix"))
    share = tmp_path / "prefix/share/base_msgs/msg"
    share.mkdir(parents=True)
    idl = "module base_msgs { module msg { struct Base { long n; }; }; };"
    if form == "msg":
        (share / "Base.msg").write_text("int32 n 5\n")
        idl = f"// generated from rosidl_adapter/resource/msg.idl.em\n{idl}"
    (share / "Base.idl").write_text(idl)
    registry = load(tmp_path / "ws", {"top_msgs/msg/Top.msg": "base_msgs/Base base\n"})
    base = registry.message("base_msgs/msg/Base")
    assert isinstance(base, Message) and base.source is not None
    assert base.source.path.suffix == f".{form}"
    assert base.fields[0].default_value == (5 if form == "msg" else None)
