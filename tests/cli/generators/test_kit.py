"""The kit for authors: `ifgen generators new`, `test`, `list` and `describe`, and the pytest fixture."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from importlib.metadata import entry_points
from pathlib import Path

import pytest
from ifgen.pipeline.generators import find, kit

from ..conftest import Run, write
from .conftest import Package

SHIPPED = sorted(
    found.name for found in entry_points(group="ifgen.generators") if found.value.startswith("ifgen_")
)
ROOT = Path(__file__).parents[3]
BOUNDS = json.dumps({"bounds": {"*.string": 32, "*.wstring": 32, "*.sequence": 4}})
"""What C needs for fields without a bound."""


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=[] if name == "mermaid" else pytest.mark.slow) for name in SHIPPED]
)
def test_what_we_ship_passes_our_own_kit(ifgen: Run, name: str) -> None:
    done = ifgen("generators", "test", name, *(["--options", BOUNDS] if name == "c" else []))
    assert (done.code, done.err) == (0, "")
    assert done.out.endswith("no mistakes\n")


def test_the_corpus_has_every_kind_of_trap(ifgen: Run, tmp_path: Path) -> None:
    assert (
        ifgen("generators", "test", "--corpus", tmp_path / "corpus").out == "corpus: 62 interfaces written\n"
    )
    files = kit.corpus()
    assert {path.rpartition(".")[2] for path in files} == {"msg", "srv", "action", "idl"}
    assert len(files["trap_msgs/msg/Large.msg"].splitlines()) == 140


@pytest.mark.slow
def test_golden_files(ifgen: Run, tmp_path: Path) -> None:
    golden = ("generators", "test", "json-schema", "--golden", tmp_path / "golden")
    assert ifgen(*golden, "--update").code == 0
    assert ifgen(*golden).code == 0
    (tmp_path / "golden/trap_msgs/msg/Plain.json").write_text("{}\n")
    (tmp_path / "golden/trap_msgs/msg/Inner.json").unlink()
    done = ifgen(*golden)
    assert done.code == 1
    assert "error: trap_msgs/msg/Inner.json is new" in done.err
    assert "error: trap_msgs/msg/Plain.json: not as in" in done.err and "-{}\n" in done.err
    assert ifgen(*golden, "--update").out.startswith("2 golden files changed\n")


TRAPS = {
    "a second run makes other files": "import os; answer['files'][0]['text'] = str(os.getpid())",
    "unknown members of the model change its files": "answer['files'][0]['text'] = str(len(request['model']))",
    "another locale, PYTHONHASHSEED, time zone or working directory makes other files": (
        "import os; answer['files'][0]['text'] = os.environ.get('TZ', '')"
    ),
    "it makes no files": "answer['files'] = []",
}


@pytest.mark.slow
@pytest.mark.parametrize("problem", TRAPS)
def test_what_the_kit_finds(ifgen: Run, tmp_path: Path, problem: str) -> None:
    write(
        tmp_path / "generate.py",
        "import json, sys\nrequest = json.load(sys.stdin)\nif request['request'] == 'describe':\n    answer = {}\n"
        f"else:\n    answer = {{'files': [{{'path': 'a', 'text': ''}}]}}\n    {TRAPS[problem]}\nprint(json.dumps(answer))\n",
    )
    done = ifgen("generators", "test", "--command", f"{sys.executable} generate.py")
    assert done.code == 1 and f"error: {problem}" in done.err.replace("a: ", "")


ELSEWHERE = """
    from pathlib import Path
    from ifgen.generators import File, Generator, Response

    def generate(request):
        return Response((File("a", EXPRESSION),))

    GENERATOR = Generator(name="theirs", version="1.0", generate=generate)
    """


@pytest.mark.slow
@pytest.mark.parametrize(
    "expression",
    [
        "str(Path.cwd())",
        "str({*'abcdefgh'})",
        "Path(__file__).with_name('a.txt').read_text()",
        "__import__('locale').getencoding()",
    ],
)
def test_the_kit_finds_what_depends_on_the_machine(ifgen: Run, package: Package, expression: str) -> None:
    package(ELSEWHERE.replace("EXPRESSION", expression), **{"a.txt": "\N{BULLET}"})
    done = ifgen("generators", "test", "theirs")
    assert done.code == 1 and "another locale, PYTHONHASHSEED, time zone or working directory" in done.err
    assert "Traceback" not in done.err


def test_list_and_describe(ifgen: Run) -> None:
    assert re.search(r"^json-schema +JSON Schema", ifgen("generators", "list").out, re.MULTILINE)
    assert 'int64 = "number"  ("number" | "string")' in ifgen("generators", "describe", "json-schema").out
    assert (
        "  model.py.j2  (blocks: imports, bases, additions)\n"
        in ifgen("generators", "describe", "pydantic").out
    )
    assert json.loads(ifgen("generators", "describe", "json-schema", "--json").out)["model"] == "1.1"
    assert "did you mean 'json-schema'?" in ifgen("generators", "describe", "json-shema").err


@pytest.mark.slow
def test_a_new_generator_passes_its_own_tests(ifgen: Run, tmp_path: Path) -> None:
    """As its author would: new, install, test. The installation is a folder on the path, which takes no time."""
    assert ifgen("generators", "new", "acme-docs").code == 0
    assert ifgen("generators", "new", "acme-docs").code == 2
    assert ifgen("generators", "new", "Acme").code == 2
    info = tmp_path / "acme-docs/acme_docs-0.1.0.dist-info"
    write(info / "METADATA", "Metadata-Version: 2.1\nName: acme-docs\nVersion: 0.1.0\n")
    write(info / "entry_points.txt", "[ifgen.generators]\nacme-docs = acme_docs:GENERATOR\n")
    run = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "tests"]
    for options, code in ((["--update-golden"], 0), ([], 0)):
        done = subprocess.run(
            [*run, *options],
            cwd=tmp_path / "acme-docs",
            env={**os.environ, "PYTHONPATH": str(tmp_path / "acme-docs")},
            capture_output=True,
            text=True,
            timeout=120,
            check=False,
        )
        assert done.returncode == code, done.stdout + done.stderr
    golden = tmp_path / "acme-docs/tests/golden/trap_msgs/msg/units.md"
    assert "| `speed` | `float64` |" in golden.read_text()


@pytest.mark.slow
@pytest.mark.parametrize("original", SHIPPED)
def test_a_copy_of_ours_makes_the_same_files(
    ifgen: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, original: str
) -> None:
    name = f"copy-of-{original}"
    assert ifgen("generators", "new", name, "--from", original).code == 0
    info = tmp_path / f"{name}/copy-0.1.0.dist-info"
    write(info / "METADATA", "Metadata-Version: 2.1\nName: copy\nVersion: 0.1.0\n")
    module = name.replace("-", "_")
    write(info / "entry_points.txt", f"[ifgen.generators]\n{name} = {module}:GENERATOR\n")
    monkeypatch.syspath_prepend(tmp_path / name)
    find.installed.cache_clear()
    options = ["--options", BOUNDS] if original == "c" else []
    try:
        golden = ["--golden", tmp_path / "golden", *options]
        assert ifgen("generators", "test", original, *golden, "--update").code == 0
        done = ifgen("generators", "test", name, *golden)
        assert (done.code, done.err) == (0, "")
    finally:
        find.installed.cache_clear()


def test_the_five_minutes_of_the_page(ifgen: Run) -> None:
    page = (ROOT / "docs/generators.md").read_text()
    [block] = re.findall(r"```console\n(.*?)```", page, re.DOTALL)
    *commands, last = [line.removeprefix("$ ") for line in block.splitlines() if line.startswith("$ ")]
    assert last == "ifgen generate"
    subprocess.run(["sh", "-ec", "\n".join(commands)], check=True, timeout=60)
    assert ifgen("generate").out == block.rpartition("$ ifgen generate\n")[2]
    assert "| `level` | `float64` | `1.0` |  | how full it is |" in Path("docs/demo_msgs.md").read_text()


def test_the_programs_and_packages_of_the_page(ifgen: Run, tmp_path: Path) -> None:
    page = (ROOT / "docs/generators.md").read_text()
    program = next(
        text for text in re.findall(r"```python\n(.*?)```", page, re.DOTALL) if "sys.stdin" in text
    )
    write(tmp_path / "generate.py", program)
    done = ifgen("generators", "test", "--command", f"{sys.executable} generate.py")
    assert (done.code, done.err) == (0, "")
