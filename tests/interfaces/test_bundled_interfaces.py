"""The bundled definitions are those of ROS 2 Jazzy, and their comments are ours."""

from __future__ import annotations

import contextlib
import io
import json
import re
import sys
import xml.etree.ElementTree as ET
from collections.abc import Iterator
from pathlib import Path

import pytest

INTERFACES = Path(__file__).parents[2] / "interfaces"
SHARE = Path(sys.prefix) / "share"
HASHES = Path(__file__).with_name("type_hashes.txt")

WITH_WHEELS = [
    "action_msgs",
    "actionlib_msgs",
    "builtin_interfaces",
    "diagnostic_msgs",
    "geometry_msgs",
    "lifecycle_msgs",
    "nav_msgs",
    "rcl_interfaces",
    "rmw_dds_common",
    "rosgraph_msgs",
    "sensor_msgs",
    "service_msgs",
    "shape_msgs",
    "std_msgs",
    "std_srvs",
    "stereo_msgs",
    "test_msgs",
    "trajectory_msgs",
    "type_description_interfaces",
    "unique_identifier_msgs",
    "visualization_msgs",
]
WITHOUT_WHEELS = ["composition_interfaces", "example_interfaces", "statistics_msgs", "tf2_msgs"]
PACKAGES = sorted([*WITH_WHEELS, *WITHOUT_WHEELS, "humanoid_interfaces"])

UNIT_SYMBOLS = {"A", "Ah", "N", "Pa", "T", "V", "deg", "degC", "kg", "lx", "m", "min", "ns", "rad", "s"}

needs_wheels = pytest.mark.skipif(
    not (SHARE / "test_msgs").is_dir(), reason="the ros-jazzy wheels are not installed in this environment"
)


def definitions(folder: Path) -> dict[str, Path]:
    """`msg/Name.msg` -> file, without the parts of services that the wheels install with them."""
    derived = ("_Request", "_Response", "_Event")
    return {
        f"{kind}/{path.name}": path
        for kind in ("msg", "srv", "action")
        for path in sorted((folder / kind).glob(f"*.{kind}"))
        if not path.stem.endswith(derived)
    }


def comment_lines(text: str) -> Iterator[str]:
    """Every comment of a definition, above or after a field, without its hash sign."""
    for line in text.splitlines():
        _, hash_sign, comment = line.partition("#")
        if hash_sign:
            yield comment.strip("# ")


def words(text: str) -> list[str]:
    """The words of a text; numbers and symbols carry facts, not wording."""
    return re.findall(r"[a-z]+(?:['_-][a-z]+)*", text.lower())


def content(package: str, path: Path) -> list[tuple[list[str], list[str]]]:
    """Fields and constants of each part, in order, as rosidl's own parser reads them."""
    parser = pytest.importorskip("rosidl_adapter.parser")
    text = path.read_text(encoding="utf-8")
    match path.suffix:
        case ".msg":
            parts = [parser.parse_message_string(package, path.stem, text)]
        case ".srv":
            specification = parser.parse_service_string(package, path.stem, text)
            parts = [specification.request, specification.response]
        case _:
            specification = parser.parse_action_string(package, path.stem, text)
            parts = [specification.goal, specification.result, specification.feedback]
    return [
        (
            [f"{field.type} {field.name} {field.default_value!r}" for field in part.fields],
            [f"{constant.type} {constant.name}={constant.value!r}" for constant in part.constants],
        )
        for part in parts
    ]


def test_the_packages_are_those_of_the_list() -> None:
    nodes_only = {folder.parent.name for folder in INTERFACES.glob("*/nodl")}
    assert sorted({folder.name for folder in INTERFACES.iterdir()} - nodes_only) == PACKAGES


@needs_wheels
@pytest.mark.parametrize("package", WITH_WHEELS)
def test_definitions_equal_those_of_the_wheel(package: str) -> None:
    ours, theirs = definitions(INTERFACES / package), definitions(SHARE / package)
    assert list(ours) == list(theirs)
    for name in theirs:
        assert content(package, ours[name]) == content(package, theirs[name]), name


@needs_wheels
def test_definitions_without_a_wheel_have_the_type_hashes_of_jazzy(tmp_path: Path) -> None:
    adapter = pytest.importorskip("rosidl_adapter")
    generator = pytest.importorskip("rosidl_generator_type_description")
    expected = dict(line.split() for line in HASHES.read_text().splitlines()[1:])
    actual: dict[str, str] = {}
    for package in WITHOUT_WHEELS:
        tuples = []
        for name in definitions(INTERFACES / package):
            relative = Path(name)
            with contextlib.redirect_stdout(io.StringIO()):
                adapter.convert_to_idl(INTERFACES / package, package, relative, tmp_path / package)
            tuples.append(f"{tmp_path / package}:{relative.with_suffix('.idl')}")
        arguments = {
            "package_name": package,
            "output_dir": str(tmp_path / "out" / package),
            "idl_tuples": tuples,
            "include_paths": [f"{folder.name}:{folder}" for folder in SHARE.iterdir() if folder.is_dir()],
        }
        arguments_file = tmp_path / f"{package}.json"
        arguments_file.write_text(json.dumps(arguments))
        for description in generator.generate_type_hash(str(arguments_file)):
            first = json.loads(Path(description).read_text())["type_hashes"][0]
            actual[first["type_name"]] = first["hash_string"]
    assert {name: value for name, value in actual.items() if "_" not in name.rsplit("/", 1)[1]} == expected


@needs_wheels
def test_constants_without_a_wheel_are_those_of_jazzy() -> None:
    # A type hash does not cover constants, and these two are all that the four packages have.
    [(_, kinds)] = content("statistics_msgs", INTERFACES / "statistics_msgs/msg/StatisticDataType.msg")
    [(_, errors)] = content("tf2_msgs", INTERFACES / "tf2_msgs/msg/TF2Error.msg")
    assert kinds == [
        "uint8 STATISTICS_DATA_TYPE_UNINITIALIZED=0",
        "uint8 STATISTICS_DATA_TYPE_AVERAGE=1",
        "uint8 STATISTICS_DATA_TYPE_MINIMUM=2",
        "uint8 STATISTICS_DATA_TYPE_MAXIMUM=3",
        "uint8 STATISTICS_DATA_TYPE_STDDEV=4",
        "uint8 STATISTICS_DATA_TYPE_SAMPLE_COUNT=5",
    ]
    assert errors == [
        "uint8 NO_ERROR=0",
        "uint8 LOOKUP_ERROR=1",
        "uint8 CONNECTIVITY_ERROR=2",
        "uint8 EXTRAPOLATION_ERROR=3",
        "uint8 INVALID_ARGUMENT_ERROR=4",
        "uint8 TIMEOUT_ERROR=5",
        "uint8 TRANSFORM_ERROR=6",
    ]
    others = {
        path
        for package in WITHOUT_WHEELS
        for path in definitions(INTERFACES / package).values()
        if any(constants for _, constants in content(package, path))
    }
    assert {path.stem for path in others} == {"StatisticDataType", "TF2Error"}


@needs_wheels
def test_rosidl_accepts_our_own_package() -> None:
    package = INTERFACES / "humanoid_interfaces"
    for path in definitions(package).values():
        content(package.name, path)
    example = INTERFACES / "example_interfaces/srv/AddTwoInts.srv"
    assert content(package.name, package / "srv/AddTwoInts.srv") == content("example_interfaces", example)


@needs_wheels
def test_comments_are_our_own_words() -> None:
    their_lines: set[tuple[str, ...]] = set()
    their_runs: set[tuple[str, ...]] = set()

    def runs(text: str) -> set[tuple[str, ...]]:
        spoken = words(" ".join(comment_lines(text)))
        return {tuple(spoken[i : i + 7]) for i in range(len(spoken) - 6)}

    for package in WITH_WHEELS:
        for path in definitions(SHARE / package).values():
            text = path.read_text(encoding="utf-8")
            their_lines |= {tuple(line) for line in map(words, comment_lines(text)) if len(line) >= 4}
            their_runs |= runs(text)
    assert len(their_lines) > 700, "the wheels' definitions were expected to have comments"
    for package in PACKAGES:
        for path in definitions(INTERFACES / package).values():
            text = path.read_text(encoding="utf-8")
            assert not {tuple(words(line)) for line in comment_lines(text)} & their_lines, path
            assert not runs(text) & their_runs, path


@pytest.mark.parametrize("package", PACKAGES)
def test_text_is_tidy(package: str) -> None:
    for path in definitions(INTERFACES / package).values():
        data = path.read_bytes()
        text = data.decode("utf-8")
        assert b"\t" not in data and b"\r" not in data, path
        assert text.endswith("\n") and not text.endswith("\n\n"), path
        assert text.startswith("# "), f"{path}: no leading comment"
        for number, line in enumerate(text.splitlines(), 1):
            assert line == line.rstrip(), f"{path}:{number}: trailing space"
            assert len(line) <= 110, f"{path}:{number}: too long"
            assert "\\" not in line.partition("#")[2], f"{path}:{number}: rosidl unescapes comments"
        for part in re.split(r"^---\n", text, flags=re.MULTILINE):
            # rosidl attaches a block of comments at the start of a part to the part, not to the field below it.
            opening = re.match(r"(#.*\n)+", part)
            assert opening is None or part[opening.end() :].startswith("\n") or opening.end() == len(part), (
                path
            )


@pytest.mark.parametrize("package", PACKAGES)
def test_brackets_in_comments_are_units(package: str) -> None:
    # rosidl takes the text of the only pair of brackets in a field's comment for the field's unit.
    for path in definitions(INTERFACES / package).values():
        above: list[str] = []
        for line in path.read_text(encoding="utf-8").splitlines():
            definition, _, comment = line.partition("#")
            above.append(comment)
            if definition or not line:
                units = re.findall(r"\[([^,\]]+)\]", " ".join(above))
                assert len(units) <= 1, f"{path}: {line}"
                assert not any(re.match(r" *\[", text) for text in above[1:]), f"{path}: {line}"
                assert set(re.findall("[A-Za-z]+|^[0-9]+$", "".join(units))) <= UNIT_SYMBOLS, (
                    f"{path}: {line}"
                )
                above.clear()


@pytest.mark.parametrize("package", PACKAGES)
def test_manifest_names_the_package_and_what_it_uses(package: str) -> None:
    manifest = ET.parse(INTERFACES / package / "package.xml").getroot()
    used = set[str]()
    for path in definitions(INTERFACES / package).values():
        used |= set(re.findall(r"^([a-z0-9_]+)/[A-Z]", path.read_text(encoding="utf-8"), flags=re.MULTILINE))
    if (INTERFACES / package / "action").is_dir():
        used.add("action_msgs")  # every action uses it
    assert manifest.attrib == {"format": "3"}
    assert manifest.findtext("name") == package
    assert manifest.findtext("license") == "Apache-2.0"
    assert manifest.findtext("member_of_group") == "rosidl_interface_packages"
    assert [element.text for element in manifest.findall("depend")] == sorted(used - {package})
    if (SHARE / package / "package.xml").is_file():
        theirs = ET.parse(SHARE / package / "package.xml").getroot()
        assert manifest.findtext("version") == theirs.findtext("version")
        assert manifest.findtext("description") != theirs.findtext("description")
