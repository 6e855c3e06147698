"""ament_index_python, beside the real one, and where no ROS is."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest
from ifgen import resources

INDEX = Path("share/ament_index/resource_index")

# Prints what each call returns, raises or warns of.
PROBES = """
import inspect, sys, warnings
import ament_index_python as ament
from ament_index_python import constants

def say(what, function, *arguments, **options):
    with warnings.catch_warnings(record=True) as warned:
        warnings.simplefilter("always")
        try:
            value = function(*arguments, **options)
            value = sorted(value) if isinstance(value, set) else value
            value = sorted(value.items()) if isinstance(value, dict) else value
            print(what, arguments, options, type(value).__name__, repr(value), end=" ")
        except Exception as error:
            bases = [base.__name__ for base in type(error).__mro__]
            print(what, arguments, bases, error, end=" ")
    print([(str(each.message), each.category.__name__, each.filename == __file__) for each in warned])

print(sorted(ament.__all__), {name: value for name, value in vars(constants).items() if name.isupper()})
for name in sorted(ament.__all__):
    member = getattr(ament, name)
    if inspect.isfunction(member):
        parameters = inspect.signature(member).parameters.values()
        print(name, [(each.name, each.kind, each.default) for each in parameters])
say("paths", ament.get_search_paths)
say("types", ament.get_resource_types)
say("all", ament.get_packages_with_prefixes)
for kind in ("packages", "plugins", "none", "", "a/b", "a\\\\b"):
    say("resources", ament.get_resources, kind)
    for name in ("alpha", "beta", "gamma", "folder", ".hidden", "none", "", "a/b", "a\\\\b", "../x"):
        say("has", ament.has_resource, kind, name)
        say("get", ament.get_resource, kind, name)
for name in ("alpha", "beta", "gamma", "missing", "a", "-a", "a/b", "", "a b", "\\u00e4b", "b-c_1", "aa\\n"):
    say("prefix", ament.get_package_prefix, name)
    for function in (ament.get_package_share_directory, ament.get_package_share_path):
        say("share", function, name)
        say("share", function, name, print_warning=False)
        say("share", function, name, False)
"""


@pytest.fixture
def tree(tmp_path: Path) -> Path:
    """Two prefixes: both have alpha, only the first has a plugin, and only alpha has a share folder."""
    for prefix, names in (("one", ("alpha", "beta", ".hidden")), ("two", ("alpha", "gamma"))):
        (tmp_path / prefix / INDEX / "packages/folder").mkdir(parents=True)
        for name in names:
            (tmp_path / prefix / INDEX / "packages" / name).write_text(f"{name} of {prefix}\n")
    (tmp_path / "one" / INDEX / "plugins").mkdir()
    (tmp_path / "one" / INDEX / "plugins/alpha").write_text("a plugin")
    (tmp_path / "one" / INDEX / ".types").mkdir()
    (tmp_path / "one" / INDEX / "file").touch()
    (tmp_path / "one/share/alpha").mkdir()
    return tmp_path


def run(program: str, prefixes: str | None, *path: Path, folder: Path) -> str:
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(map(str, path))}
    environment.pop("AMENT_PREFIX_PATH", None)
    if prefixes is not None:
        environment["AMENT_PREFIX_PATH"] = prefixes
    script = folder / "script.py"
    script.write_text(program)
    done = subprocess.run(
        [sys.executable, script], env=environment, capture_output=True, text=True, timeout=60, check=False
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.mark.parametrize(
    "prefixes", ["{0}/one:{0}/two", "{0}/two:{0}/one", ":{0}/none::{0}/two:", "{0}/none"]
)
def test_it_is_upstreams(prefixes: str, tree: Path) -> None:
    pytest.importorskip("rclpy", reason="the ROS wheels are not installed (Linux x86_64 only)")
    prefixes = prefixes.format(tree).replace(":", os.pathsep)
    real = run(PROBES, prefixes, folder=tree)
    ours = run(PROBES, prefixes, resources.libraries(), folder=tree)
    assert ours.splitlines() == real.splitlines()
    assert len(real.splitlines()) > 200


WITHOUT = """
import sys
import ament_index_python as ament
sys.prefix = {prefix!r}
def tried(function, *arguments):
    try:
        return function(*arguments)
    except Exception as error:
        return f"{{type(error).__name__}}: {{error}}"
"""


def without_ros(tree: Path, calls: str, *path: Path, folder: Path) -> list[str]:
    program = WITHOUT.format(prefix=str(tree)) + calls
    return run(program, None, *path, resources.libraries(), folder=folder).splitlines()


def test_what_pip_installed_is_found(tree: Path) -> None:
    one = tree / "one"
    calls = """
print(tried(ament.get_search_paths))
print(tried(ament.get_package_share_directory, "alpha"))
print(tried(ament.get_package_prefix, "missing"))
"""
    assert without_ros(one, calls, folder=tree) == [
        str([str(one)]),
        f"{one}/share/alpha",
        f"PackageNotFoundError: \"package 'missing' not found, searching: {[str(one)]}\"",
    ]


def test_sources_are_found_from_a_program_of_theirs(tree: Path) -> None:
    source = tree / "src/my_pkg"
    for package in (source, tree / "src/folder_of_another", tree / "src/broken"):
        package.mkdir(parents=True)
    (source / "my_pkg").mkdir()
    (source / "my_pkg/__init__.py").touch()
    (source / "package.xml").write_text("<package format='3'><name> my_pkg </name></package>")
    (tree / "src/folder_of_another/package.xml").write_text(
        "<package><name>robot_description</name></package>"
    )
    (tree / "src/broken/package.xml").write_text("<package><name>broken")
    calls = """
for name in ("my_pkg", "folder_of_another", "broken"):
    print(tried(ament.get_package_share_directory, name))
print(repr(ament.get_package_share_path("my_pkg")))
print(tried(ament.get_package_prefix, "my_pkg"))
"""
    why = "not found: Environment variable 'AMENT_PREFIX_PATH' is not set or empty"
    mine, others, broken = (
        f"PackageNotFoundError: \"package '{name}' {why}\""
        for name in ("my_pkg", "folder_of_another", "broken")
    )
    expected = [str(source), others, broken, repr(source), mine]
    assert without_ros(tree / "none", calls, folder=source / "my_pkg") == expected  # beside the program
    assert without_ros(tree / "none", calls, source, folder=tree) == expected  # on the path
    other = tree / "src/other"
    other.mkdir()
    assert without_ros(tree / "none", calls, folder=other) == expected  # a sibling


def test_sources_do_not_count_beside_a_ros(tree: Path) -> None:
    source = tree / "src/my_pkg"
    source.mkdir(parents=True)
    (source / "package.xml").write_text("<package><name>my_pkg</name></package>")
    program = "import ament_index_python as a\ntry: a.get_package_share_path('my_pkg')\nexcept KeyError: print('none')"
    assert run(program, str(tree / "one"), resources.libraries(), folder=source) == "none\n"
