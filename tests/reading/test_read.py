"""The files that are found, their packages, and the search for dependencies."""

from __future__ import annotations

import os
import sys
from pathlib import Path

import pytest
from ifgen import resources
from ifgen.diagnostics import InputError
from ifgen.pipeline.inspection import inspect
from ifgen.reading.packages import InterfaceFile, find_packages
from ifgen.reading.search_path import SearchPath


def make(root: Path, *names: str, text: str = "") -> Path:
    """Make files below a folder."""
    for name in names:
        path = root / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
    return root


def rules(error: InputError) -> list[str]:
    """The rules that are broken."""
    return [diagnostic.rule for diagnostic in error.diagnostics]


def found(*paths: Path) -> dict[str, list[str]]:
    """Packages by name, with their files."""
    return {
        package.name: sorted(f"{file.folder}/{file.path.name}" for file in package.files)
        for package in find_packages(paths)
    }


def test_a_package_a_folder_of_packages_and_a_file(tmp_path: Path) -> None:
    """A path is a package's folder, one of its folders, a folder above at any depth, or a file."""
    make(tmp_path, "src/deep/a_msgs/msg/A.msg", "src/deep/a_msgs/srv/S.srv", "src/b_msgs/action/B.action")
    package = tmp_path / "src/deep/a_msgs"
    whole = {"a_msgs": ["msg/A.msg", "srv/S.srv"]}
    assert found(package) == whole
    assert found(tmp_path) == {**whole, "b_msgs": ["action/B.action"]}
    assert found(package / "msg/A.msg") == found(package / "msg") == {"a_msgs": ["msg/A.msg"]}
    assert found(package / "msg/A.msg", tmp_path, package) == found(tmp_path)


LIST = "project(listed_msgs)\nrosidl_generate_interfaces(${PROJECT_NAME} %s)"
XML = "<package><name>listed_msgs</name></package>"


def test_a_list_decides_which_files_and_which_types(tmp_path: Path) -> None:
    """Listed files count in folders of any name, and files that are not listed do not."""
    make(tmp_path, "p/srvs/S.srv", "p/msg/deep/M.msg", "p/msg/Old.msg", "p/msg/A.action")
    make(tmp_path, "p/package.xml", text=XML)
    make(tmp_path, "p/CMakeLists.txt", text=LIST % "srvs/S.srv msg/deep/M.msg msg/A.action")
    whole = {"listed_msgs": ["action/A.action", "msg/M.msg", "srv/S.srv"]}
    assert found(tmp_path) == found(tmp_path / "p") == whole
    assert found(tmp_path / "p/srvs") == found(tmp_path / "p/srvs/S.srv") == {"listed_msgs": ["srv/S.srv"]}
    assert found(tmp_path / "p/msg/deep/M.msg") == {"listed_msgs": ["msg/M.msg"]}
    assert found(tmp_path / "p/msg") == {"listed_msgs": ["action/A.action", "msg/M.msg"]}
    assert found(tmp_path / "p/msg/Old.msg") == {"listed_msgs": ["msg/Old.msg"]}, "asked for by name"
    (package,) = find_packages([tmp_path / "p/srvs"])
    assert {(file.folder, file.name) for file in package.known_files()} == {
        ("srv", "S"),
        ("msg", "M"),
        ("action", "A"),
    }
    (package,) = find_packages([tmp_path / "p/msg/Old.msg"])
    assert package.listed is not None
    assert [d.rule for d in package.listed.diagnostics] == ["unlisted-interface"]


def test_a_single_file_is_of_the_package_around_it(tmp_path: Path) -> None:
    """The nearest package.xml above names it; a package without one within another is its own."""
    make(tmp_path, "p/package.xml", text=XML)
    make(tmp_path, "p/srvs/S.srv", "p/idl/deep/M.msg", "p/inner_msgs/msg/A.msg", "p/nodl/n.nodl.yaml")
    assert found(tmp_path / "p/srvs/S.srv") == {"listed_msgs": ["srv/S.srv"]}
    assert found(tmp_path / "p/idl/deep/M.msg") == {"listed_msgs": ["msg/M.msg"]}
    assert found(tmp_path / "p/inner_msgs/msg/A.msg") == {"inner_msgs": ["msg/A.msg"]}
    assert found(tmp_path / "p/inner_msgs/msg") == {"inner_msgs": ["msg/A.msg"]}
    assert found(tmp_path / "p/nodl/n.nodl.yaml") == {"listed_msgs": []}


def test_installed_packages_have_what_the_ament_index_lists(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As ROS installs slam_toolbox: services are in `srvs`, each with the files made from it."""
    share = make(
        tmp_path / "share",
        *("slam/srvs/S.srv", "slam/srv/S.idl", "slam/srvs/S_Request.msg", "slam/msg/M.msg", "slam/msg/M.idl"),
        *("slam/msg/Stale.msg", "plain_msgs/msg/A.msg"),
    )
    index = "ament_index/resource_index/rosidl_interfaces/slam"
    make(share, index, text="msg/M.idl\nmsg/M.msg\nsrv/S.idl\nsrvs/S.srv\nsrvs/S_Request.msg\nmsg/Gone.msg\n")
    make(share, "slam/package.xml", text="<package><name>slam</name></package>")
    monkeypatch.setenv("AMENT_PREFIX_PATH", str(tmp_path))
    search = SearchPath()
    package = search.package("slam")
    assert package is not None
    assert [(file.folder, file.name) for file in package.files] == [("msg", "M"), ("srv", "S")]
    assert {"slam", "plain_msgs"} <= set(search.package_names())
    assert search.packages_with("S", "srv") == ["slam"]
    assert found(share) == {"plain_msgs": ["msg/A.msg"], "slam": ["msg/M.msg", "srv/S.srv"]}


def test_what_ifgen_generated_is_no_source(tmp_path: Path) -> None:
    """A folder with a manifest is skipped, unless it was generated into its own source."""
    manifest = '{"format": 1, "generator": "", "source": "%s", "interfaces": ["msg/A"], "files": {}}'
    make(tmp_path, "src/a_msgs/msg/A.msg", "out/a_msgs/msg/A.msg")
    make(tmp_path, "out/a_msgs/.ifgen-manifest.json", text=manifest % "../src/a_msgs")
    assert [package.root for package in find_packages([tmp_path])] == [tmp_path / "src/a_msgs"]
    with pytest.raises(InputError, match="ifgen generated"):
        find_packages([tmp_path / "out/a_msgs"])
    make(tmp_path, "src/a_msgs/.ifgen-manifest.json", text=manifest % "a_msgs")
    assert found(tmp_path) == {"a_msgs": ["msg/A.msg"]}


@pytest.mark.skipif(sys.platform == "win32", reason="no such files there")
@pytest.mark.parametrize("kind", ["pipe", "device", "folder", "too large", "link to nothing"])
@pytest.mark.parametrize(
    "name", ["msg/A.msg", "msg/B.idl", "package.xml", "CMakeLists.txt", "nodl/n.nodl.yaml"]
)
def test_only_files_of_a_sensible_size_are_read(tmp_path: Path, name: str, kind: str) -> None:
    """Anything else is an error or ignored; nothing blocks or uses up the memory."""
    make(tmp_path / "a_msgs", "msg/B.msg")
    path = tmp_path / "a_msgs" / name
    path.parent.mkdir(exist_ok=True)
    match kind:
        case "pipe":
            os.mkfifo(path)
        case "device":
            path.symlink_to("/dev/zero")
        case "folder":
            path.mkdir()
        case "too large":
            with path.open("wb") as file:
                file.truncate(5 * 2**20)
        case _:
            path.symlink_to("nowhere")
    findings = inspect(tmp_path).diagnostics
    is_there = name.endswith((".msg", ".idl", ".yaml")) or kind == "too large"
    told = {d.rule for d in findings} - {"two-files"}  # a rule of its own for an .idl file beside a .msg file
    assert told == ({"unreadable-path"} if is_there else set())
    if name == "msg/A.msg":
        listed = "rosidl_generate_interfaces(a_msgs msg/A.msg msg/B.msg)"
        make(tmp_path / "a_msgs", "CMakeLists.txt", text=listed)
        assert {d.rule for d in inspect(tmp_path).diagnostics} == {"unreadable-path"}


def test_a_file_outside_a_package_folder_counts(tmp_path: Path) -> None:
    """A loose file belongs to a package with its folder's name."""
    make(tmp_path, "demo_msgs/A.msg")
    assert found(tmp_path / "demo_msgs/A.msg") == {"demo_msgs": ["msg/A.msg"]}


def test_parts_that_ros_installs_are_passed_over(tmp_path: Path) -> None:
    """An installed package has a service's or action's parts next to it; in msg/ such a name is a message's."""
    make(
        tmp_path,
        "a_msgs/srv/S.srv",
        "a_msgs/srv/S_Request.msg",
        "a_msgs/srv/S_Event.msg",
        "a_msgs/srv/T_Event.msg",
    )
    make(
        tmp_path,
        "a_msgs/msg/M.msg",
        "a_msgs/msg/M_Request.msg",
        "a_msgs/action/A.action",
        "a_msgs/action/A_Goal.msg",
    )
    assert found(tmp_path) == {
        "a_msgs": ["action/A.action", "msg/M.msg", "msg/M_Request.msg", "srv/S.srv", "srv/T_Event.msg"]
    }


ADAPTED = "// generated from rosidl_adapter/resource/msg.idl.em\n"


def test_idl_files_beside_others(tmp_path: Path) -> None:
    """They are interfaces too, unless rosidl_adapter made them from another file there."""
    make(tmp_path, "a_msgs/msg/A.msg", "a_msgs/srv/S.srv", "a_msgs/msg/B.idl", "a_msgs/msg/C.msg")
    make(tmp_path, "a_msgs/msg/A.idl", "a_msgs/srv/S.idl", "a_msgs/msg/D.idl", text=ADAPTED)
    make(tmp_path, "a_msgs/msg/C.idl", "a_msgs/srv/T.idl", "a_msgs/srv/T_Request.msg", text="module")
    assert found(tmp_path) == {
        "a_msgs": [
            *("msg/A.msg", "msg/B.idl", "msg/C.idl", "msg/C.msg", "msg/D.idl"),
            *("srv/S.srv", "srv/T.idl"),
        ]
    }


def test_idl_files_alone(tmp_path: Path) -> None:
    """A package may have only .idl files; a single file denotes its package, and its folder tells its kind."""
    make(tmp_path, "a_msgs/msg/A.idl", "a_msgs/srv/S.idl", "a_msgs/action/G.idl", "b_msgs/B.idl")
    (package,) = find_packages([tmp_path / "a_msgs"])
    assert [(file.name, file.kind) for file in package.files] == [("G", "action"), ("A", "msg"), ("S", "srv")]
    assert found(tmp_path / "a_msgs/srv/S.idl") == found(tmp_path / "a_msgs/srv") == {"a_msgs": ["srv/S.idl"]}
    (loose,) = find_packages([tmp_path / "b_msgs/B.idl"])
    assert [(file.name, file.kind) for file in loose.files] == [("B", "msg")]


def test_idl_files_that_are_installed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The ament index lists them with the files that they were made from, or alone."""
    share = tmp_path / "prefix/share"
    monkeypatch.setenv("AMENT_PREFIX_PATH", str(tmp_path / "prefix"))
    make(share, "a_msgs/msg/A.msg", "a_msgs/msg/A.idl", "a_msgs/msg/B.idl", text=ADAPTED)
    for listed in (False, True):
        if listed:
            make(
                share,
                "ament_index/resource_index/rosidl_interfaces/a_msgs",
                text="msg/A.idl\nmsg/A.msg\nmsg/B.idl",
            )
        package = SearchPath().package("a_msgs")
        assert package is not None
        assert sorted(file.path.name for file in package.files) == ["A.msg", "B.idl"]


def test_the_name_is_that_of_package_xml(tmp_path: Path) -> None:
    """The folder's name does not matter if there is a package.xml."""
    make(tmp_path, "some-checkout/msg/A.msg")
    make(
        tmp_path,
        "some-checkout/package.xml",
        text="<package><!-- <name>x</name> --><name> real_msgs </name></package>",
    )
    (package,) = find_packages([tmp_path])
    assert package.name == "real_msgs"
    assert package.declared is not None
    text = package.declared.source.text
    assert text[package.declared.start : package.declared.end] == "real_msgs"


def test_the_working_directory_has_a_name(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """`.` is the package of the working directory."""
    monkeypatch.chdir(make(tmp_path / "demo_msgs", "msg/A.msg"))
    assert found(Path()) == {"demo_msgs": ["msg/A.msg"]}
    monkeypatch.chdir("msg")
    assert found(Path()) == found(Path("A.msg")) == {"demo_msgs": ["msg/A.msg"]}


def test_what_is_not_looked_into(tmp_path: Path) -> None:
    """Ignored, hidden and build folders are skipped, but not if they are named."""
    make(tmp_path, "ignored/COLCON_IGNORE", "also/AMENT_IGNORE", "fine_msgs/msg/A.msg")
    for folder in ("ignored", "also", ".hidden", "build", "install", "log"):
        make(tmp_path, f"{folder}/x_msgs/msg/A.msg")
    make(tmp_path, "fine_msgs/nested_msgs/msg/A.msg", "fine_msgs/msg/.A.msg", "fine_msgs/msg/A.msg.orig")
    assert found(tmp_path) == {"fine_msgs": ["msg/A.msg"]}
    assert found(tmp_path / "install") == {"x_msgs": ["msg/A.msg"]}


@pytest.mark.skipif(sys.platform == "win32", reason="links need rights there")
def test_links_are_followed_once(tmp_path: Path) -> None:
    """Workspaces link packages into place; a link to a parent folder does not lead to an endless search."""
    make(tmp_path, "elsewhere/a_msgs/msg/A.msg", "src/README")
    (tmp_path / "src/a_msgs").symlink_to(tmp_path / "elsewhere/a_msgs")
    (tmp_path / "src/loop").symlink_to(tmp_path / "src")
    assert found(tmp_path / "src") == {"a_msgs": ["msg/A.msg"]}


def test_paths_that_lead_nowhere(tmp_path: Path) -> None:
    """Every path that does not exist or has no interfaces is reported."""
    make(tmp_path, "empty/README", "some.txt")
    with pytest.raises(InputError) as caught:
        find_packages([tmp_path / "missing", tmp_path / "empty", tmp_path / "some.txt"])
    assert rules(caught.value) == ["unreadable-path", "no-interfaces", "no-interfaces"]


def test_every_broken_package_xml_is_reported(tmp_path: Path) -> None:
    """One broken package.xml does not hide another."""
    make(tmp_path, "a_msgs/msg/A.msg", "b_msgs/msg/B.msg")
    make(tmp_path, "a_msgs/package.xml", "b_msgs/package.xml", text="<package>")
    with pytest.raises(InputError) as caught:
        find_packages([tmp_path])
    assert rules(caught.value) == ["bad-package-xml", "bad-package-xml"]


def test_a_byte_that_is_not_utf8(tmp_path: Path) -> None:
    """The byte is named, and its line and column."""
    path = tmp_path / "A.msg"
    path.write_bytes("# é\r\n# ä".encode() + b" \xe9\n")
    with pytest.raises(InputError) as caught:
        InterfaceFile(path, "msg").read()
    (diagnostic,) = caught.value.diagnostics
    assert diagnostic.primary is not None
    assert (diagnostic.primary.span.line, diagnostic.primary.span.column) == (2, 5)
    assert diagnostic.message == "the file is not UTF-8: byte 0xe9 at offset 11"


@pytest.mark.skipif(os.name == "nt" or os.geteuid() == 0, reason="everything can be read here")
def test_a_file_that_cannot_be_read(tmp_path: Path) -> None:
    """A file that the user may not read is an error of its own."""
    path = make(tmp_path, "A.msg") / "A.msg"
    path.chmod(0)
    with pytest.raises(InputError, match="cannot read"):
        InterfaceFile(path, "msg").read()


def test_dependencies_are_found_in_order(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The order: given packages, folders to include, AMENT_PREFIX_PATH, the interpreter's share/, bundled packages."""
    places = [tmp_path / name for name in ("given", "include", "ament", "prefix", "bundled")]
    given, include, ament, prefix, bundled = places
    monkeypatch.setenv("AMENT_PREFIX_PATH", os.pathsep.join([str(tmp_path / "missing"), str(ament)]))
    monkeypatch.setattr(sys, "prefix", str(prefix))
    monkeypatch.setattr(resources, "bundled_interfaces", lambda: bundled)
    roots = [given, include / "any/depth", ament / "share", prefix / "share", bundled]
    for number, root in enumerate(roots):
        make(root, *(f"p{earlier}/msg/A.msg" for earlier in range(number + 1)))
    search = SearchPath(find_packages([given]), [include])
    packages = [search.package(f"p{number}") for number in range(len(roots))]
    assert [package and package.root for package in packages] == [
        root / f"p{number}" for number, root in enumerate(roots)
    ]
    assert search.package("nowhere") is None
    assert search.package_names() == ["p0", "p1", "p2", "p3", "p4"]
    assert search.packages_with("A") == ["p0", "p1", "p2", "p3", "p4"]


def test_a_folder_to_include_must_exist(tmp_path: Path) -> None:
    """A wrong -I is reported at once."""
    with pytest.raises(InputError, match="there is no"):
        SearchPath((), [tmp_path / "missing"])


@pytest.mark.parametrize("encoding", ["shift_jis", "nonsense", "hex"])
def test_a_package_xml_in_an_unknown_encoding(tmp_path: Path, encoding: str) -> None:
    """The XML parser has many kinds of errors; the user gets one."""
    make(tmp_path, "a/msg/A.msg")
    make(
        tmp_path,
        "a/package.xml",
        text=f'<?xml version="1.0" encoding="{encoding}"?><package><name>a</name></package>',
    )
    with pytest.raises(InputError) as caught:
        find_packages([tmp_path])
    assert rules(caught.value) == ["bad-package-xml"]
