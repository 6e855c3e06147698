"""Generated TypeScript: its text, tsc, the conformance suite, and the program of its page."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from ..conformance.support import TYPESCRIPT, node_modules, run_suite
from .support import ALL, ROOT, example_of, generate, run
from .testees import compiled_typescript


@pytest.fixture(scope="session")
def compiler(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The program tsc."""
    return node_modules(tmp_path_factory.mktemp("npm"), TYPESCRIPT) / ".bin/tsc"


@pytest.fixture(scope="module")
def battery(tmp_path_factory: pytest.TempPathFactory) -> str:
    folder = tmp_path_factory.mktemp("battery")
    generate(
        folder, "typescript", "ts", ROOT / "interfaces/sensor_msgs", only=["sensor_msgs/msg/BatteryState"]
    )
    assert not (folder / "ts/sensor_msgs/msg/Imu.ts").exists()
    assert (folder / "ts/std_msgs/msg/Header.ts").exists(), "what it needs"
    return (folder / "ts/sensor_msgs/msg/BatteryState.ts").read_text()


def test_a_field_offers_its_constants(battery: str) -> None:
    assert "  power_supply_health: 0 | 1 | 2 | 3 | 4 | 5 | 6 | 7 | 8 | (number & {});\n" in battery
    assert "  POWER_SUPPLY_HEALTH_COLD: 6,\n" in battery


def test_only_what_is_used_is_imported(battery: str) -> None:
    lines = [line for line in battery.splitlines() if line.startswith("import")]
    assert lines == [
        'import * as cdr from "../../cdr.js";',
        'import { Header } from "../../std_msgs/msg/Header.js";',
    ]


def test_arrays_are_typed(battery: str) -> None:
    assert "  cell_voltage: Float32Array;\n" in battery
    assert "cell_voltage ?? new Float32Array(0),\n" in battery


@pytest.mark.slow
@pytest.mark.parametrize(
    "options", [{"int64": "number"}, {"arrays": "plain"}, {"int64": "number", "arrays": "plain"}]
)
def test_every_option_passes_the_suite(compiler: Path, tmp_path: Path, options: dict[str, Any]) -> None:
    only = ["conformance_msgs", "test_msgs", "std_msgs", "sensor_msgs"]
    output = compiled_typescript(
        compiler, generate(tmp_path, "typescript", "ts", *ALL, only=only, testee=True, **options)
    )
    patterns = [
        "alignment/*",
        "bounds/*",
        "types/test_msgs/*",
        "types/sensor_msgs/*",
        "hostile/conformance_msgs/*",
    ]
    listed = tmp_path / "failures.txt"
    listed.write_text("some *  numbers beyond 2^53 are not exact\n" if "int64" in options else "")
    arguments = [word for pattern in patterns for word in ("--only", pattern)]
    code, text = run_suite(["node", str(output / "testee.js")], *arguments, "--failures", str(listed))
    assert code == 0, text
    if "int64" in options:
        names = [
            "--only",
            "alignment/Int32/*",
            "--only",
            "alignment/Float64/*",
            "--only",
            "alignment/Int64/unbounded/*/0:*",
        ]
        code, text = run_suite(["node", str(output / "testee.js")], *names)
        assert code == 0, text


@pytest.mark.slow
def test_the_program_of_the_page_runs(compiler: Path, tmp_path: Path) -> None:
    blocks = example_of("typescript.md", tmp_path)
    (tmp_path / "src").mkdir()
    generate(tmp_path, "typescript", "src/ros", tmp_path / "demo_msgs")
    program = "declare const console: { log(...words: unknown[]): void };\n" + blocks["typescript"]
    (tmp_path / "src/main.ts").write_text(program)
    output = compiled_typescript(compiler, tmp_path / "src")
    assert run(["node", "main.js"], output) == blocks["output"]


PROGRAM = """
import { Float64 } from "./std_msgs/msg/Float64.js";
import { JointState } from "./sensor_msgs/msg/JointState.js";
import { Image } from "./sensor_msgs/msg/Image.js";

const message = (task) => { try { task(); return "no error"; } catch (error) { return `${error.constructor.name}: ${error.message}`; } };
const joints = (values) => () => JointState.encode({ ...JointState.create(), ...values });
const image = Image.encode(Image.create({ data: Uint8Array.of(1, 2, 3), header: { stamp: { sec: 1, nanosec: 2 }, frame_id: "c" } }));
const shifted = new Uint8Array(image.length + 3).subarray(3);
shifted.set(image);
const view = Image.decode(image), copy = Image.decode(image, { copy: true });
image[image.length - 1] = 9;
const results = [
  message(joints({ position: ["a"] })),
  message(joints({ name: ["a", "b\\ud800"] })),
  message(joints({ name: ["nul\\0"] })),
  message(joints({ header: undefined })),
  message(joints({ header: { stamp: { sec: 2 ** 31, nanosec: 0 }, frame_id: "" } })),
  message(() => Float64.encode({ data: 1n })),
  message(() => Float64.decode(Uint8Array.of(0, 1, 0))),
  message(() => Float64.decode(Uint8Array.of(0, 1, 0, 0, 1))),
  view.data.join(), copy.data.join(), Image.decode(shifted).data.join(),
  JointState.decode(JointState.encode(JointState.create({ position: Float64Array.from({ length: 100000 }, (_, i) => i) }))).position[99999],
  message(() => JointState.encode({ ...JointState.create(), get effort() { JointState.encode(JointState.create()); return Float64Array.of(1); } })),
];
console.log(results.join("\\n"));
"""
EXPECTED = """\
EncodeError: JointState.position[0]: expected a number, got "a"
EncodeError: JointState.name[1]: expected a string without half of a surrogate pair, got "b\\ud800"
EncodeError: JointState.name[0]: expected a string without NUL, got "nul\\u0000"
EncodeError: JointState.header: expected std_msgs/msg/Header, got undefined
EncodeError: JointState.header.stamp.sec: expected an integer from -2147483648 to 2147483647, got 2147483648
EncodeError: Float64.data: expected a number, got 1n
DecodeError: expected a header of 4 bytes, got 3 bytes
DecodeError: expected 8 bytes at 4, the payload ends at 5
1,2,9
1,2,3
1,2,3
99999
no error
"""


@pytest.mark.slow
def test_wrong_values_and_views(compiler: Path, tmp_path: Path) -> None:
    source = generate(
        tmp_path, "typescript", "ts", ROOT / "interfaces/sensor_msgs", ROOT / "interfaces/std_msgs"
    )
    output = compiled_typescript(compiler, source)
    (output / "program.js").write_text(PROGRAM)
    assert run(["node", "program.js"], output) == EXPECTED
