"""`ifgen adapt`: where it finds the other version, what it writes and never overwrites, and its errors."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import ifgen as toolkit
import pytest

from tests.cli.conftest import Git, Outcome, Run, commit, write

ROOT = Path(__file__).resolve().parents[3]
SPEED = Path("interfaces/robot_msgs/msg/Speed.msg")
TYPE = "robot_msgs/msg/Speed"
HASH = "RIHS01_4e1cd23d"


@pytest.fixture
def versions(git: Git, ifgen: Run) -> None:
    """The tag v1 with an int8, a lock file of it, and an int16 now."""
    write(Path("pyproject.toml"), '[tool.ifgen]\npaths = ["interfaces"]\n')
    write(SPEED, "int8 value\n")
    commit(git)
    git("tag", "v1")
    write(Path("elsewhere/robot_msgs/msg/Speed.msg"), "int8 value\n")
    write(SPEED, "int16 value\n")


def hash_of(ifgen: Run, version: str = "v1") -> str:
    """The type hash of Speed in a version."""
    shown = ifgen("diff", f"{version}:{TYPE}", TYPE).out
    return next(word for line in shown.splitlines() for word in line.split() if word.startswith("RIHS01_"))[
        :23
    ]


def written(done: Outcome) -> list[str]:
    assert done.code == 0, done.err
    return [line.split(" ")[1].split(":")[0] for line in done.out.splitlines() if line.startswith("wrote ")]


@pytest.mark.usefixtures("versions")
def test_it_writes_a_package(ifgen: Run) -> None:
    digits = hash_of(ifgen)[7:15]
    assert ifgen("adapt", TYPE, "--from", "v1") == Outcome(
        0,
        f"wrote adapters/speed_{digits}.py\n"
        f"wrote adapters/test_adapt_speed_{digits}.py\n"
        "wrote adapters/__init__.py\n"
        f"wrote adapters/_speed_{digits}.py\n"
        "next: `pytest adapters`, then import the package where your program starts\n",
        "",
    )


@pytest.mark.usefixtures("versions")
def test_it_overwrites_nothing(ifgen: Run) -> None:
    module, test, *_ = written(ifgen("adapt", TYPE, "--from", "v1"))
    Path(module).write_text("# mine\n")
    done = ifgen("adapt", TYPE, "--from", "v1")
    assert done == Outcome(
        2,
        "",
        f"error[existing-file]: {module} exists, and is yours\n"
        "  = help: change it by hand, or delete it and its test to have them written\n"
        "          again\n",
    )
    Path(module).unlink()
    Path(test).write_text("# mine\n")
    assert written(ifgen("adapt", TYPE, "--from", "v1")) == [module]
    assert Path(test).read_text() == "# mine\n"


@pytest.mark.usefixtures("versions")
@pytest.mark.parametrize(
    "reference", ["v1", "elsewhere", "./elsewhere", f"v1:{TYPE}", "elsewhere/robot_msgs/msg/Speed.msg"]
)
def test_what_a_reference_may_be(ifgen: Run, reference: str) -> None:
    assert written(ifgen("adapt", TYPE, "--from", reference))


@pytest.mark.usefixtures("versions")
def test_a_hash_is_looked_for_in_the_lock_file_its_history_and_that_of_the_type(
    ifgen: Run,
    git: Git,
) -> None:
    shown = hash_of(ifgen)
    now = SPEED.read_text()
    assert written(ifgen("adapt", TYPE, "--from", f"{shown}...", "-o", "a"))  # the file, in the commit of v1
    SPEED.write_text("int8 value\n")
    ifgen("lock")
    SPEED.write_text(now)
    assert written(ifgen("adapt", TYPE, "--from", shown, "-o", "b"))
    assert "(ifgen.lock)" in next(Path("b").glob("speed_*")).read_text()
    commit(git)
    ifgen("lock")
    assert written(ifgen("adapt", TYPE, "--from", shown[7:15], "-o", "c"))
    assert ":ifgen.lock)" in next(Path("c").glob("speed_*")).read_text()


@pytest.mark.usefixtures("versions")
def test_a_lock_file_is_a_version(ifgen: Run) -> None:
    now = SPEED.read_text()
    SPEED.write_text("int8 value\n")
    ifgen("lock")
    SPEED.write_text(now)
    frozen = written(ifgen("adapt", TYPE, "--from", "ifgen.lock"))[-1]
    assert '__source__ = """\\\n"""' in Path(frozen).read_text()
    lock = Path("ifgen.lock")
    lock.write_text(lock.read_text().replace("int8 value", "int8 other"))
    done = ifgen("adapt", TYPE, "--from", "ifgen.lock", "-o", "more")
    assert done.code == 1 and done.err.startswith(
        "error[invalid-lock]: the hash of robot_msgs/msg/Speed does not"
    )
    assert not Path("more").exists()


@pytest.mark.usefixtures("versions")
def test_a_description_is_a_version(ifgen: Run) -> None:
    now = SPEED.read_text()
    SPEED.write_text("int8 value\n")
    document = json.loads(ifgen("show", "--json", TYPE).out)
    SPEED.write_text(now)
    write(Path("plain.json"), json.dumps(document))
    assert written(ifgen("adapt", TYPE, "--from", "plain.json", "-o", "a"))
    hashes = [{"type_name": TYPE, "hash_string": "RIHS01_" + "1" * 64}]
    write(Path("lie.json"), json.dumps({"type_description_msg": document, "type_hashes": hashes}))
    write(Path("other.json"), ifgen("show", "--json", "std_msgs/msg/Bool").out)
    document["type_description"]["fields"][0]["type"] |= {"type_id": 50, "capacity": 2**40}
    write(Path("huge.json"), json.dumps(document))
    write(Path("broken.json"), "[" * 100_000)
    for name, message in (
        ("lie", "error[invalid-description]: the description of robot_msgs/msg/Speed does not fit"),
        ("other", "error[unknown-type]: other.json describes std_msgs/msg/Bool, not robot_msgs/msg/Speed"),
        ("huge", "error[invalid-description]: "),
        ("broken", "error[invalid-description]: broken.json is not the JSON of a type description: "),
    ):
        done = ifgen("adapt", TYPE, "--from", f"{name}.json", "-o", "b")
        assert done.code and done.err.startswith(message), done
        assert not Path("b").exists()


@pytest.mark.usefixtures("versions")
@pytest.mark.parametrize(
    ("type_", "reference", "message"),
    [
        (TYPE, "v2", "error[unknown-revision]: 'v2' is neither a revision of "),
        (TYPE, "RIHS01_9", f"error[unknown-hash]: nobody knows a version of {TYPE} with the hash RIHS01_9\n"),
        (
            TYPE,
            "0123456789",
            f"error[unknown-hash]: nobody knows a version of {TYPE} with the hash 0123456789\n",
        ),
        (
            TYPE,
            "interfaces",
            f"error[nothing-to-adapt]: there is nothing to adapt: {TYPE} has the same type hash in",
        ),
        (TYPE, "v1:std_srvs", f"error[unknown-type]: v1:std_srvs has no {TYPE}\n"),
        (
            TYPE,
            "v1:std_srvs/srv/Empty",
            "error[unknown-type]: v1:std_srvs/srv/Empty is the std_srvs/srv/Empty, ",
        ),
        ("robot_msgs/msg/Gone", "v1", "error[unknown-type]: there is no type 'robot_msgs/msg/Gone'\n"),
        ("robot_msgs", "v1", "error[unknown-type]: robot_msgs is not a single type\n"),
        ("robot_msgs/msg/New", "v1", "error[unknown-type]: v1 has no robot_msgs/msg/New\n"),
        (TYPE, "\0", "error["),
    ],
)
def test_wrong_references(ifgen: Run, type_: str, reference: str, message: str) -> None:
    write(SPEED.with_name("New.msg"), "int8 a\n")
    done = ifgen("adapt", type_, "--from", reference)
    assert done.code == 2 and done.out == ""
    assert done.err.startswith(message)
    assert not Path("adapters").exists()


@pytest.mark.usefixtures("versions")
def test_digits_of_several_versions(ifgen: Run, git: Git) -> None:
    commit_of_v1 = subprocess.run(
        ["git", "rev-parse", "v1"], capture_output=True, text=True, check=True
    ).stdout[:12]
    assert written(ifgen("adapt", TYPE, "--from", commit_of_v1, "-o", "a"))
    digits = hash_of(ifgen)[7:15]
    SPEED.write_text("int8 value\n")
    ifgen("lock")
    SPEED.write_text("int16 value\n")
    git("tag", digits)
    done = ifgen("adapt", TYPE, "--from", digits, "-o", "b")
    assert done.code == 2 and done.err.startswith(
        f"error[ambiguous-hash]: '{digits}' stands for several versions"
    )


@pytest.mark.usefixtures("versions")
def test_folders_that_cannot_be_written(ifgen: Run) -> None:
    write(Path("file"), "")
    assert ifgen("adapt", TYPE, "--from", "v1", "-o", "file").code == 2
    done = ifgen("adapt", TYPE, "--from", "v1", "-o", "file/below")
    assert done.code == 1 and done.err.startswith("error: file/below: Not a directory\n")


@pytest.mark.usefixtures("versions")
def test_files_that_are_there_already(ifgen: Run) -> None:
    """The package is the user's, and a frozen module has to be the one that belongs there."""
    package = write(Path("adapters/__init__.py"), '"""Mine."""\n')
    module, _, frozen = written(ifgen("adapt", TYPE, "--from", "v1"))
    Path(module).unlink()
    Path(frozen).write_text("# another one\n")
    done = ifgen("adapt", TYPE, "--from", "v1")
    assert done.code == 2
    assert done.err.startswith(f"error[existing-file]: {frozen} exists, and is not the frozen {TYPE}\n")
    assert not Path(module).exists()
    Path(frozen).unlink()
    done = ifgen("adapt", TYPE, "--from", "v1")
    assert f"adapters/__init__.py is yours: add `from . import {Path(module).stem}` to it\n" in done.out
    assert package.read_text() == '"""Mine."""\n'


@pytest.mark.usefixtures("versions")
def test_a_description_that_holds_a_part_of_a_service(ifgen: Run) -> None:
    document = json.loads(ifgen("show", "--json", TYPE).out)
    nested = {"type_id": 1, "capacity": 0, "string_capacity": 0, "nested_type_name": "a_msgs/srv/A_Request"}
    field = {"name": "part", "type": nested, "default_value": ""}
    part = {"type_name": "a_msgs/srv/A_Request", "fields": document["type_description"]["fields"].copy()}
    document["type_description"]["fields"].append(field)
    document["referenced_type_descriptions"].append(part)
    write(Path("part.json"), json.dumps(document))
    done = ifgen("adapt", TYPE, "--from", "part.json")
    assert done.code == 1 and done.err.startswith(
        f"error[invalid-description]: {TYPE} holds a_msgs/srv/A_Request"
    )


@pytest.mark.usefixtures("versions")
def test_the_folder_can_be_configured(ifgen: Run) -> None:
    write(Path("pyproject.toml"), '[tool.ifgen]\npaths = ["interfaces"]\nadapters = "src/robot/adapters"\n')
    assert written(ifgen("adapt", TYPE, "--from", "v1"))[0].startswith("src/robot/adapters/speed_")


@pytest.mark.usefixtures("versions")
def test_templates_can_be_replaced(ifgen: Run) -> None:
    write(Path("pyproject.toml"), '[tool.ifgen]\npaths = ["interfaces"]\ntemplates = "own"\n')
    text = (
        '{% extends "ifgen/adapter_package/adapter.py.j2" %}\n{% block additions %}\n# ours\n{% endblock %}\n'
    )
    write(Path("own/adapter_package/adapter.py.j2"), text)
    module, *_ = written(ifgen("adapt", TYPE, "--from", "v1"))
    assert Path(module).read_text().endswith("# ours\n")


@pytest.mark.usefixtures("versions")
def test_messages_that_are_too_large_to_be_tried_have_no_test(ifgen: Run) -> None:
    write(Path("elsewhere/robot_msgs/msg/Speed.msg"), "int8[100000] value\n")
    SPEED.write_text("int8[100001] value\n")
    done = ifgen("adapt", TYPE, "--from", "elsewhere")
    assert "there is no test: these messages are too large to be tried\n" in done.out
    assert not any("test_adapt" in name for name in written(done))


def program(code: str, *options: str) -> str:
    """What a program prints that knows the generated packages, and no toolkit."""
    paths = [".", "generated", ROOT / "generated", ROOT / "codegen"]
    environment = os.environ | {"PYTHONPATH": os.pathsep.join(map(str, paths))}
    command = [sys.executable, *options, "-c", f"import sys; sys.modules['ifgen'] = None\n{code}"]
    done = subprocess.run(command, capture_output=True, text=True, env=environment, timeout=60, check=False)
    return done.stdout if done.returncode == 0 else done.stderr.splitlines()[-1]


READ = """
from ifgen_runtime.adapters import adapter_for, decode
from robot_msgs.msg import Speed
import adapters, pickle, {module} as old
frozen = old.Speed(value=7)
assert pickle.loads(pickle.dumps(frozen)) == frozen
print(decode(frozen.__serialize__(), old.Speed.__type_hash__, Speed))
"""


@pytest.mark.usefixtures("versions")
def test_versions_are_chained_from_file_to_file(ifgen: Run, git: Git, tmp_path: Path) -> None:
    """A program at the third version reads bytes of the first one, without the toolkit."""
    first, *_, frozen = written(ifgen("adapt", TYPE, "--from", "v1"))
    toolkit.generate("interfaces", output="generated")
    read = READ.format(module=frozen.removesuffix(".py").replace("/", "."))
    assert program(read) == "robot_msgs.msg.Speed(value=7)\n"
    commit(git)
    git("tag", "v2")
    SPEED.write_text("int32 value\n")
    toolkit.generate("interfaces", output="generated")
    done = ifgen("adapt", TYPE, "--from", "v2")
    *_, frozen = written(done)
    digits = frozen[-11:-3]
    advice = f"freezes that version, and `from ._speed_{digits} import Speed` imports it into this module"
    assert f"was written for Speed {digits}, " in program(read) and advice in program(read)
    hint = f"{first} converts to this version: import it there, with `from ._speed_{digits} import Speed`\n"
    assert hint in done.out
    path = Path(first)
    path.write_text(
        path.read_text().replace(
            "from robot_msgs.msg import Speed\n", f"from ._speed_{digits} import Speed\n"
        )
    )
    assert program(read) == "robot_msgs.msg.Speed(value=7)\n"


@pytest.mark.slow
@pytest.mark.parametrize("transport", ["local", "rclpy"])
def test_the_tests_fail_until_all_is_decided(ifgen: Run, git: Git, transport: str) -> None:
    write(Path("pyproject.toml"), '[tool.ifgen]\npaths = ["interfaces"]\n')
    write(SPEED, "std_msgs/Header header\nfloat32 value\nuint8 from\n")
    commit(git)
    write(SPEED, "std_msgs/Header header\nfloat64 other\nfloat32 value\nint16 from\n")
    toolkit.generate("interfaces", output="generated")
    module, *_ = written(ifgen("adapt", TYPE, "--from", "HEAD", "--downgrade"))
    command = [
        sys.executable,
        "-m",
        "pytest",
        "-q",
        "adapters",
        "--transport",
        transport,
        "-p",
        "no:cacheprovider",
    ]

    def results() -> str:
        done = subprocess.run(command, capture_output=True, text=True, timeout=120, check=False)
        return done.stdout.splitlines()[-1]

    assert "5 failed" in results()
    text = Path(module).read_text()
    text = text.replace(
        'other=undecided(\n            "`other` is new, and has no default",\n        ),', "other=0.1,"
    )
    lost = '    lost(\n        new.other,\n        "`new.other` has no field here: use it, or delete this call",\n    )\n'
    text = text.replace(lost, "")
    question = '"`from` is `uint8`, and `new.from_` is `int16`: does it always fit?",'
    text = text.replace(
        f"from_=undecided(\n            {question}\n        ),", "from_=max(0, min(255, new.from_)),"
    )
    Path(module).write_text(text)
    assert "5 passed" in results()


@pytest.mark.slow
def test_both_type_checkers_report_what_is_open_and_nothing_else(ifgen: Run) -> None:
    write(Path("pyproject.toml"), '[tool.ifgen]\npaths = ["interfaces"]\n')
    cell, pack = "float32 voltage  # [V]\nint8 gone\n", "Cell[] cells\nint8[] a\nstring[2] b\nbyte[] c\n"
    write(Path("old/robot_msgs/msg/Cell.msg"), cell)
    write(Path("old/robot_msgs/msg/Pack.msg"), f"{pack}Cell one\nfloat64[] d\nstring[] e\nbool f\n")
    write(Path("interfaces/robot_msgs/msg/Cell.msg"), "float32 voltage  # [mV]\n")
    new = f"{pack}geometry_msgs/Point one\nfloat32[] d\nstring[3] e\nbool[<=1] f\nwstring g\nstd_msgs/Header h\n"
    write(Path("interfaces/robot_msgs/msg/Pack.msg"), new)
    toolkit.generate("interfaces", output="generated")
    module, *_ = written(ifgen("adapt", "robot_msgs/msg/Pack", "--from", "old", "--downgrade"))
    lines = Path(module).read_text().splitlines()
    expected = {n for n, line in enumerate(lines, 1) if line.endswith("=undecided(")}
    expected |= {n + 1 for n, line in enumerate(lines, 1) if line == "    lost("}
    assert len(expected) > 10
    search = [
        str(path) for path in ("generated", ROOT / "generated", ROOT / "codegen", ROOT / "codegen/underlay")
    ]
    settings = {"include": ["adapters"], "typeCheckingMode": "strict", "extraPaths": search}
    write(Path("pyrightconfig.json"), json.dumps(settings))
    write(Path("mypy.ini"), "[mypy]\nstrict = True\n")
    environment = os.environ | {"MYPYPATH": ":".join(search)}
    for command in (
        [sys.executable, "-m", "mypy", "--config-file", "mypy.ini", "-p", "adapters"],
        [sys.executable, "-m", "pyright", "--pythonpath", sys.executable],
    ):
        done = subprocess.run(
            command, capture_output=True, text=True, env=environment, timeout=300, check=False
        )
        places = re.findall(
            rf"^ *\S*{re.escape(module)}:(\d+)(?::\d+)?(?: -|:) error", done.stdout, re.MULTILINE
        )
        assert set(map(int, places)) == expected, done.stdout
        assert f"{len(expected)} errors" in done.stdout
