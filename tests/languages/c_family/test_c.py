"""The generator of C: bounds, names, sizes, and the conformance suite on three processors."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest
from ifgen.model import Model
from ifgen_generators.c import GENERATOR

from ...conformance.support import tool
from .support import IFGEN, ROOT, WARNINGS, build, generate, load, passes, run, write

EVERYTHING = {"*.string": 512, "*.wstring": 64, "*.sequence": 8}
ROBOT = {
    "std_msgs/msg/Header.frame_id": 32,
    "sensor_msgs/msg/JointState.name[]": 23,
    "sensor_msgs/msg/JointState.*": 32,
}
STRICT = ["-std=c99", *WARNINGS]
CORTEX = ["-mthumb", "-ffreestanding", "-Os", "-Wcast-align=strict"]


def interface(folder: Path, text: str) -> Model:
    path = folder / "a_msgs/msg/Thing.msg"
    path.parent.mkdir(parents=True)
    path.write_text(text, "utf-8")
    return load(folder / "a_msgs")


def file(model: Model, path: str, **options: object) -> str:
    response = generate(GENERATOR, model, **options)
    assert response.findings == ()
    (content,) = (file.content for file in response.files if file.path == path)
    assert isinstance(content, str)
    return content


def test_a_field_without_a_bound_is_an_error_at_the_field(tmp_path: Path) -> None:
    model = interface(tmp_path, "string name\nuint8[] data\nstring[] names\nstring<=3 short\n")
    findings = generate(GENERATOR, model, bounds={"a_msgs/msg/Thing.names": 3}).findings
    assert [finding.element for finding in findings] == [
        "a_msgs/msg/Thing.name",
        "a_msgs/msg/Thing.data",
        "a_msgs/msg/Thing.names",
    ]
    assert findings[2].help is not None
    assert '"a_msgs/msg/Thing.names[]" = 32' in findings[2].help


def test_a_key_for_one_field_wins_and_a_pattern_leaves_declared_bounds_alone(tmp_path: Path) -> None:
    model = interface(tmp_path, "string name\nstring other\nstring<=3 short\nuint8[<=5] data\nwstring wide\n")
    bounds = {"*.string": 9, "a_msgs/msg/Thing.other": 7, "*.wstring": 5, "*.sequence": 2}
    text = file(model, "a_msgs/msg/thing.h", bounds=bounds)
    assert "char name[10];" in text
    assert "char other[8];" in text
    assert "char short_[13];" in text  # three characters of four bytes, and a word of C
    assert "uint8_t data[5];" in text
    assert "uint16_t data[6]; } wide;" in text  # an even number


@pytest.mark.parametrize(
    ("bounds", "message"),
    [
        ({"a_msgs/msg/Thing.nam": 4}, "'a_msgs/msg/Thing.nam', which is no string or sequence"),
        ({"*.string": 0}, "a bound is a whole number from 1"),
        ({"*.string": True}, "a bound is a whole number from 1"),
        ({"*.string": 3}, "the default of this field is longer than its bound"),
    ],
)
def test_a_wrong_bound_is_an_error(tmp_path: Path, bounds: dict[str, object], message: str) -> None:
    model = interface(tmp_path, "string name hello\n")
    findings = generate(GENERATOR, model, bounds={"*.string": 8, **bounds}).findings
    assert any(message in finding.message for finding in findings)


def test_payloads_have_the_size_of_the_macro_at_most(tmp_path: Path) -> None:
    model = interface(tmp_path, "uint8 a\nfloat64 b\nstring<=2 c\nbool[<=3] d\nwstring<=1 e\n")
    # 1 + 7 + 8, then 4 + 9, then 3 + 4 + 3, then 3 + 4 + 8, and the header
    assert "Thing_MAX_SIZE 58u" in file(model, "a_msgs/msg/thing.h")


@pytest.fixture(scope="module")
def everything() -> Model:
    return load(ROOT / "interfaces", ROOT / "tests/conformance/interfaces")


@pytest.mark.slow
def test_all_packages_compile_freestanding(everything: Model, tmp_path: Path) -> None:
    write(generate(GENERATOR, everything, bounds=EVERYTHING), tmp_path)
    own = {tmp_path / "ifgen/cdr.c", tmp_path / "ifgen/equal.c"}
    whole = tmp_path / "all.c"
    whole.write_text("".join(f'#include "{path}"\n' for path in sorted(set(tmp_path.rglob("*.c")) - own)))
    for source in (*own, whole):
        run([tool("gcc"), *STRICT, "-ffreestanding", f"-I{tmp_path}", "-fsyntax-only", str(source)])


@pytest.mark.slow
def test_the_suite_passes_on_a_big_endian_processor(everything: Model, tmp_path: Path) -> None:
    emulator = tool("qemu-ppc")
    write(generate(GENERATOR, everything, bounds=EVERYTHING, testee=True), tmp_path)
    compiler = [tool("powerpc-linux-gnu-gcc"), *STRICT, "-O1"]
    testee = build(tmp_path, compiler, ".c", tmp_path / "program", ["-static"])
    assert passes(emulator, str(testee))


@pytest.mark.slow
@pytest.mark.parametrize("processor", ["cortex-m0", "cortex-m4"])
def test_a_message_takes_less_than_500_bytes_of_flash(tmp_path: Path, processor: str) -> None:
    compiler = [tool("arm-none-eabi-gcc"), f"-mcpu={processor}", *CORTEX, *STRICT, f"-I{tmp_path}", "-c"]
    write(
        generate(GENERATOR, load(ROOT / "interfaces/sensor_msgs"), bounds={**EVERYTHING, **ROBOT}), tmp_path
    )
    for source, most in (
        ("sensor_msgs/msg/imu.c", 500),
        ("sensor_msgs/msg/joint_state.c", 500),
        ("ifgen/cdr.c", 1700),
    ):
        output = tmp_path / "object.o"
        run([*compiler, "-fstack-usage", str(tmp_path / source), "-o", str(output)])
        text, data, bss = map(int, run(["arm-none-eabi-size", str(output)]).splitlines()[1].split()[:3])
        assert (text < most, data, bss) == (True, 0, 0), (source, text)
        stack = [line.split("\t") for line in output.with_suffix(".su").read_text().splitlines()]
        assert all(int(size) < 200 and kind == "static" for _, size, kind in stack)


@pytest.mark.slow
def test_a_microcontroller_publishes_what_python_reads(tmp_path: Path) -> None:
    tool("arm-none-eabi-gcc")
    tool("qemu-system-arm")
    firmware = ROOT / "examples/languages/firmware"
    for path in (
        firmware / "pyproject.toml",
        firmware / "Makefile",
        firmware / "bridge.py",
        *firmware.glob("src/*"),
    ):
        target = tmp_path / "languages/firmware/a" / path.relative_to(firmware)
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_bytes(path.read_bytes())
    project = tmp_path / "languages/firmware/a"
    config = project / "pyproject.toml"
    config.write_text(config.read_text().replace("../../../interfaces", str(ROOT / "interfaces")))
    run(["make", f"IFGEN={IFGEN}"], project)
    done = subprocess.run(
        [str(IFGEN), "run", str(project / "bridge.py")],
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout.splitlines() == [
        "imu_link 9.5",
        "['left', 'right'] [0.0, 0.0]",
        "imu_link 10.5",
        "['left', 'right'] [0.0, 0.25]",
        "imu_link 11.5",
        "['left', 'right'] [0.0, 0.5]",
    ]
