"""`[tool.ifgen.generate]`: what generators make, where it goes, and what is refused."""

from __future__ import annotations

import json
import os
from pathlib import Path

import pytest
from ifgen.pipeline.generators import programs

from ..conftest import Run, write
from .conftest import Package, Program

SET = """
    from pathlib import Path
    from ifgen.generators import Generator, Option, Output

    GENERATOR = Generator(
        name="theirs",
        version="1.0",
        options=(Option("title", "string", "Docs"), Option("deep", "boolean", False)),
        templates=Path(__file__).parent / "templates",
        filters=Path(__file__).parent / "filters.py",
        outputs=(
            Output("one.md.j2", "{package}/{interface:snake}.md", "interface"),
            Output("all.json.j2", "all.json", "run"),
        ),
    )
    """
FILES = {
    "templates__one.md.j2": "# {{ options.title }}: {{ interface.name|shout }}\n",
    "templates__all.json.j2": "{{ packages|tojson }}\n",
    "filters.py": "def shout(text: str) -> str:\n    return text.upper()\n",
}


def test_a_set_of_templates(ifgen: Run, package: Package) -> None:
    package(SET, **FILES)
    done = ifgen("generate")
    assert (done.code, done.err) == (0, "")
    assert done.out.endswith("docs: 2 files written\n")
    assert Path("docs/a_msgs/dot.md").read_text() == "# Docs: DOT\n"
    [found] = json.loads(Path("docs/all.json").read_text())
    assert found["interfaces"][0]["messages"] == ["a_msgs/msg/Dot"]
    assert Path("generated/a_msgs/msg/_dot.py").is_file()
    again = ifgen("generate")
    assert again.out.endswith("docs: up to date (2 files)\n")
    assert ifgen("generate", "--check").code == 0


def test_files_come_and_go_with_their_interfaces(ifgen: Run, package: Package) -> None:
    package(SET, **FILES)
    write(Path("interfaces/a_msgs/msg/Gone.msg"), "bool x\n")
    assert ifgen("generate").code == 0
    Path("interfaces/a_msgs/msg/Gone.msg").unlink()
    assert "removed docs/a_msgs/gone.md\n" in ifgen("generate").out
    assert not Path("docs/a_msgs/gone.md").exists()
    Path("docs/a_msgs/dot.md").write_text("edited")
    drift = ifgen("generate", "--check")
    assert drift.code == 1 and "# Docs: DOT" in drift.out
    assert "docs/.ifgen-edited/a_msgs/dot.md" in ifgen("generate").err
    assert Path("docs/a_msgs/dot.md").read_text() == "# Docs: DOT\n"


def test_a_file_of_somebody_else_stays(ifgen: Run, package: Package) -> None:
    package(SET, **FILES)
    write(Path("docs/all.json"), "mine")
    done = ifgen("generate")
    assert done.code == 1 and "docs/all.json is in the way" in done.err
    assert not Path("generated").exists() and not Path("docs/a_msgs").exists()


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ("titel = 1", "generator 'theirs' has no option 'titel'"),
        ("title = 1", "option 'title' of generator 'theirs' must be a string"),
        ('deep = "yes"', "option 'deep' of generator 'theirs' must be true or false"),
    ],
)
def test_a_wrong_option(ifgen: Run, package: Package, options: str, message: str) -> None:
    package(SET, **FILES)
    with Path("pyproject.toml").open("a") as file:
        file.write(f"options = {{ {options} }}\n")
    done = ifgen("generate")
    assert done.code == 1 and message in done.err and "pyproject.toml:6:13" in done.err
    assert not Path("generated").exists()


def test_a_function(ifgen: Run, package: Package) -> None:
    package(
        """
        from ifgen.generators import File, Generator, Response

        def generate(request):
            types = [of for of in request.model.types if of.generate]
            return Response(tuple(File(f"{of.name}.bin", of.type_hash.encode()) for of in types))

        GENERATOR = Generator(name="theirs", version="1.0", generate=generate)
        """
    )
    assert ifgen("generate").code == 0
    assert Path("docs/Dot.bin").read_bytes().startswith(b"RIHS01_")


def test_a_program(ifgen: Run, program: Program) -> None:
    program()
    done = ifgen("generate")
    assert (done.code, done.err, done.out) == (0, "", "out: 1 file written\n")
    assert Path("out/a_msgs/msg/Dot.txt").read_text().startswith("RIHS01_")
    assert not Path("generated").exists()
    assert ifgen("generate").out == "out: up to date (1 file)\n"


def test_an_error_of_a_program_has_the_place_of_the_element(ifgen: Run, program: Program) -> None:
    program(
        'answer = {"diagnostics": [{"element": "a_msgs/msg/Dot.x", "severity": "error", "message": "no", '
        '"help": "do not"}]}'
    )
    done = ifgen("generate")
    assert done.code == 1
    assert done.err.startswith("error[generator]: mine: no\n --> interfaces/a_msgs/msg/Dot.msg:1:9\n")
    assert "help: do not" in done.err


def test_a_feature_that_is_missing_is_refused_at_the_field(ifgen: Run, program: Program) -> None:
    program(description='{"features": ["unbounded"]}')
    done = ifgen("generate")
    assert done.code == 1
    assert "generator 'mine' 1.2 does not support wide strings: a_msgs/msg/Dot.name" in done.err
    assert "interfaces/a_msgs/msg/Dot.msg:2:9" in done.err


def test_what_is_not_supported_is_left_out_on_request(ifgen: Run, program: Program) -> None:
    program(description='{"features": ["unbounded"]}', unsupported="skip")
    write(Path("interfaces/a_msgs/msg/Other.msg"), "float64 x\n")
    write(Path("interfaces/a_msgs/msg/User.msg"), "Dot dot\n")
    done = ifgen("generate")
    assert done.code == 0 and "a_msgs/msg/Dot is left out" in done.err
    assert sorted(path.name for path in Path("out").rglob("*.txt")) == ["Other.txt"]


def test_only_and_with_deps(ifgen: Run, program: Program) -> None:
    program(only=["*/msg/Pose"], with_deps=True)
    write(Path("interfaces/a_msgs/msg/Pose.msg"), "geometry_msgs/Point at\n")
    assert ifgen("generate").code == 0
    assert sorted(path.name for path in Path("out").rglob("*.txt")) == ["Point.txt", "Pose.txt"]
    program(only=["b_msgs"])
    assert "'b_msgs' in `only` matches nothing" in ifgen("generate").err


BAD = {
    "crash": ("raise SystemExit('no luck')", "ended with exit code 1 when asked to generate"),
    "garbage": ("print('hello'); sys.exit()", "answered 'generate' with what is no JSON: 'hello'"),
    "list": ("answer = []", "the answer is no JSON object"),
    "empty": ("answer = {}", "the answer has neither 'files' nor 'diagnostics'"),
    "outside": ("answer['files'][0]['path'] = '../x'", "wants to write '../x': that is outside its folder"),
    "absolute": ("answer['files'][0]['path'] = '/tmp/x'", "wants to write '/tmp/x': that is outside"),
    "drive": ("answer['files'][0]['path'] = 'C:/x'", "wants to write 'C:/x': that is outside"),
    "backslash": ("answer['files'][0]['path'] = 'a\\\\b'", "that is not the plain path of a file"),
    "manifest": ("answer['files'][0]['path'] = '.ifgen-targets.json'", "that is ifgen's own list of files"),
    "twice": (
        "answer['files'] += [{'path': 'a_msgs/msg/DOT.txt', 'text': ''}]",
        "writes a_msgs/msg/DOT.txt twice",
    ),
    "text": ("answer['files'][0]['text'] = 1", "'text' of 'a_msgs/msg/Dot.txt' is no text"),
    "both": ("answer['files'][0]['base64'] = 'AA=='", "needs either 'text' or 'base64'"),
    "base64": ("answer['files'] = [{'path': 'x', 'base64': '?'}]", "'base64' of 'x' is none"),
    "severity": (
        "answer['diagnostics'] = [{'severity': 'bad', 'message': ''}]",
        "'severity' of a diagnostic",
    ),
    "python": ("answer['files'][0] = {'path': 'x.py', 'text': '\\ndef x('}", "makes a broken file: x.py:2: "),
    "half": ("print(json.dumps(answer)[:-9]); sys.exit()", "answered 'generate' with what is no JSON: '{"),
    "nothing": ("sys.exit()", "answered 'generate' with what is no JSON: ''"),
    "bytes": ("sys.stdout.buffer.write(bytes([255, 254])); sys.exit()", "with what is no JSON"),
    "megabytes": ("print('x' * 5_000_000); sys.exit()", "with what is no JSON: 'xxxxxxxx"),
    "endless": ("while True: print('x' * 100_000)", "answered 'generate' with more than "),
    "deep": ("print('[' * 100_000); sys.exit()", "with what is no JSON: '[[[[[["),
    "hang": ("import time; time.sleep(60)", "did not answer '"),
    # What it starts has its pipes, and ends with it.
    "child": (
        "import subprocess; subprocess.Popen(['sleep', '60']); sys.exit()",
        "did not answer '",
    ),
    "killed": ("import os; os.kill(os.getpid(), 9)", "ended with exit code -9 when asked to generate"),
    "inside": ("answer['files'][0]['path'] = 'a/../../x'", "wants to write 'a/../../x': that is outside"),
    "network": ("answer['files'][0]['path'] = '//host/x'", "wants to write '//host/x': that is"),
    "folder": ("answer['files'][0]['path'] = 'a/'", "that is not the plain path of a file"),
    "none": ("answer['files'][0]['path'] = ''", "that is not the plain path of a file"),
    "nul": ("answer['files'][0]['path'] = 'a\\0b'", "that is not the plain path of a file"),
    "surrogate": ("answer['files'][0]['text'] = '\\ud800'", "makes a broken file: a_msgs/msg/Dot.txt"),
    "both kinds": (
        "answer['files'] += [{'path': 'a_msgs/msg/Dot.txt/x', 'text': ''}]",
        "writes a_msgs/msg/Dot.txt/x, but a_msgs/msg/Dot.txt is a file, too",
    ),
    "symlink": ("answer['files'][0]['path'] = 'link/x.txt'", "out/link is "),
    "element": (
        "answer['diagnostics'] = [{'severity': 'warning', 'message': 'hm', 'element': 'no/msg/Such'}]",
        "names an element that is not in the model: 'no/msg/Such'",
    ),
}


@pytest.mark.parametrize("name", BAD)
def test_a_bad_answer_is_one_error_and_old_files_stay(
    ifgen: Run, program: Program, monkeypatch: pytest.MonkeyPatch, name: str
) -> None:
    body, message = BAD[name]
    program("answer['files'] += [{'path': 'old.txt', 'text': 'old'}]")
    assert ifgen("generate").code == 0
    Path("elsewhere").mkdir()
    Path("out/link").symlink_to(Path("elsewhere").absolute())
    before = {path: path.read_bytes() for path in sorted(Path("out").rglob("*")) if path.is_file()}
    monkeypatch.setattr(programs, "MAX_GENERATED", 10_000_000)
    program(body, time_limit=1 if name in {"hang", "child"} else 60)
    done = ifgen("generate")
    assert done.code == 1 and done.err.count("error[") == 1
    assert message in done.err and ("'mine'" in done.err or name == "symlink") and len(done.err) < 3000
    assert {path: path.read_bytes() for path in sorted(Path("out").rglob("*")) if path.is_file()} == before
    assert not list(Path("elsewhere").iterdir()) and not Path("x").exists()


def test_a_program_that_is_not_there(ifgen: Run, program: Program) -> None:
    program()
    text = Path("pyproject.toml").read_text()
    Path("pyproject.toml").write_text(text.replace(f'"{os.sys.executable}"', '"no-such-program"'))
    assert "cannot be started: no-such-program: No such file or directory" in ifgen("generate").err


def test_a_program_that_wants_a_newer_model(ifgen: Run, program: Program) -> None:
    program(description='{"model": "1.7"}')
    assert "generator 'mine' needs model 1.7, and ifgen has model 1.1" in ifgen("generate").err
    program(description='{"model": "2.0"}')
    assert "needs model 2.0" in ifgen("generate").err


def test_two_targets_that_want_one_file(ifgen: Run, program: Program) -> None:
    program()
    text = Path("pyproject.toml").read_text()
    second = text.partition("[tool.ifgen.generate.mine]")[2]
    Path("pyproject.toml").write_text(f"{text}[tool.ifgen.generate.more]{second}")
    done = ifgen("generate")
    assert done.code == 1 and not Path("out").exists()
    assert "generators 'mine' and 'more' both write a_msgs/msg/Dot.txt" in done.err


def test_a_target_that_wants_a_file_of_ours(ifgen: Run, program: Program) -> None:
    program("answer['files'][0]['path'] = 'a_msgs/__init__.py'; answer['files'][0]['text'] = ''")
    text = Path("pyproject.toml").read_text()
    Path("pyproject.toml").write_text(text.replace("python = false", "").replace('"out"', '"generated"'))
    done = ifgen("generate")
    assert done.code == 1 and "generated/a_msgs/__init__.py would be written twice" in done.err
    assert not Path("generated").exists()


def test_a_broken_target_keeps_all_others_from_writing(ifgen: Run, program: Program) -> None:
    program("raise SystemExit(3)")
    text = Path("pyproject.toml").read_text().replace("python = false", "")
    Path("pyproject.toml").write_text(f'{text}[tool.ifgen.generate.web]\nuse = "json-schema"\nout = "web"\n')
    assert ifgen("generate").code == 1
    assert not Path("generated").exists() and not Path("web").exists()


@pytest.mark.parametrize(
    ("module", "message"),
    [
        ("raise RuntimeError('no')", "cannot be loaded: RuntimeError: no"),
        ("GENERATOR = 1", "is no Generator"),
        (
            "from ifgen.generators import Generator\n"
            "GENERATOR = Generator(name='theirs', version='', generate=lambda request: 1 / 0)",
            "generator 'theirs' failed: ZeroDivisionError: division by zero (__init__.py:2)",
        ),
    ],
)
def test_a_broken_package(ifgen: Run, package: Package, module: str, message: str) -> None:
    package(module)
    done = ifgen("generate")
    assert done.code == 1 and message in done.err and "pyproject.toml:4:1" in done.err
    assert not Path("generated").exists()


def test_an_unknown_generator(ifgen: Run, package: Package) -> None:
    package("GENERATOR = 1")
    text = Path("pyproject.toml").read_text()
    Path("pyproject.toml").write_text(text.replace('"theirs"', '"json-shema"'))
    done = ifgen("generate")
    assert "there is no generator 'json-shema'" in done.err and "did you mean 'json-schema'?" in done.err


def test_a_template_that_makes_a_broken_file(ifgen: Run, package: Package) -> None:
    package(SET.replace("{interface:snake}.md", "{interface:snake}.toml"), **FILES)
    done = ifgen("generate")
    assert done.code == 0  # a comment
    files = {**FILES, "templates__one.md.j2": "a = 1\n{% if true %}\nb = {{ interface.name }}\n{% endif %}\n"}
    package(SET.replace("{interface:snake}.md", "{interface:snake}.toml"), **files)
    done = ifgen("generate")
    assert "template one.md.j2 makes a broken file: a_msgs/dot.toml:2: " in done.err
    assert "templates/one.md.j2:3:1" in done.err


OURS = """\
[tool.ifgen]
paths = ["interfaces"]
python = false
[tool.ifgen.generate.docs]
use = "markdown"
out = "docs"
"""


def _project(*lines: str) -> None:
    write(Path("interfaces/a_msgs/msg/Dot.msg"), "float64 x\n")
    write(Path("pyproject.toml"), OURS + "".join(f"{line}\n" for line in lines))


@pytest.mark.parametrize("name", ["pages", "package:acme_pages/docs"])
def test_templates_of_a_set_are_replaced(ifgen: Run, monkeypatch: pytest.MonkeyPatch, name: str) -> None:
    folder = Path("pages")
    if name != "pages":
        write(Path("site/acme_pages/__init__.py"), "")
        monkeypatch.syspath_prepend(Path("site").absolute())
        folder = Path("site/acme_pages/docs")
    write(
        folder / "package.md.j2",
        '{% extends "markdown/package.md.j2" %}\n{% block title %}\n{{ super() }}\nOf Acme.\n{% endblock %}\n',
    )
    _project(f'templates = "{name}"')
    done = ifgen("generate")
    assert (done.code, done.err) == (0, "")
    assert Path("docs/a_msgs.md").read_text().startswith("# a\\_msgs\n\nOf Acme.\n")
    write(folder / "package.md.j2", "{{ package.name }}\n")
    assert ifgen("generate").out == "docs: 1 file written, 1 file unchanged\n"
    assert Path("docs/a_msgs.md").read_text() == "a_msgs\n"


@pytest.mark.parametrize(
    ("line", "file", "message"),
    [
        ('templates = "pages"', "pages/pakage.md.j2", "markdown has no template pakage.md.j2"),
        ('templates = "elsewhere"', "pages/x", "pyproject.toml:7:1"),
        ('templates = "package:no_such/pages"', "pages/x", "pyproject.toml:7:1"),
    ],
)
def test_templates_that_replace_nothing(ifgen: Run, line: str, file: str, message: str) -> None:
    write(Path(file), "")
    _project(line)
    done = ifgen("generate")
    assert done.code != 0 and message in done.err and done.err.count("error[") == 1
    assert not Path("docs").exists()


def test_a_generator_without_templates_can_be_copied(ifgen: Run) -> None:
    write(Path("pages/x.j2"), "")
    _project('templates = "pages"')
    Path("pyproject.toml").write_text(OURS.replace("markdown", "mermaid") + 'templates = "pages"\n')
    done = ifgen("generate")
    assert "pyproject.toml:7:1" in done.err and "generators new NAME --from mermaid" in done.err


def test_a_formatter_reads_and_writes_texts(ifgen: Run) -> None:
    _project('format = { "*.md" = ["sed", "s,^# ,# {path} ,"] }')
    assert ifgen("generate").out == "docs: 2 files written\n"
    assert Path("docs/a_msgs.md").read_text().startswith(f"# {Path('docs/a_msgs.md').absolute()} a")
    assert ifgen("generate").out == "docs: up to date (2 files)\n"
    assert ifgen("generate", "--check").code == 0


@pytest.mark.parametrize(
    ("command", "message"),
    [
        ('["sh", "-c", "echo no >&2; exit 3"]', "ended with exit code 3 for "),
        ('["no-such-program"]', "cannot be started: no-such-program: No such file or directory"),
        ('["printf", "\\\\377"]', "wrote no UTF-8 for "),
        ('["sleep", "9"]', "took too long for "),
        ("[]", "must be a table of programs"),
        ('"prettier"', "must be a table of programs"),
    ],
)
def test_a_formatter_that_fails(ifgen: Run, command: str, message: str) -> None:
    _project(f'format = {{ "*.md" = {command} }}', "time_limit = 0.3")
    done = ifgen("generate")
    assert done.code != 0 and message in done.err and "pyproject.toml:7:" in done.err
    assert done.err.count("error[") == 1 and not Path("docs").exists()


def test_the_kit_warns_of_lines_that_run_together(ifgen: Run, package: Package) -> None:
    files = SET.replace("{package}/{interface", "{package}/{folder}/{interface")
    package(files, **FILES | {"templates__one.md.j2": "a\n{%- if true %}\nb\n{%- endif %}\n"})
    done = ifgen("generators", "test", "theirs")
    assert done.code == 0 and "warning[trimmed-line]" in done.err and "one.md.j2:2:1" in done.err


def test_a_run_on_a_part_leaves_targets_alone_and_says_so(ifgen: Run) -> None:
    _project()
    write(Path("interfaces/b_msgs/msg/Dot.msg"), "float64 y\n")
    assert ifgen("generate").out == "docs: 3 files written\n"
    write(Path("interfaces/b_msgs/msg/Dot.msg"), "float64 z\n")
    said = ifgen("generate", "interfaces/b_msgs").out
    assert said == "docs: as before, because targets are about all paths: run `ifgen generate` without PATH\n"
    assert "`y`" in Path("docs/b_msgs.md").read_text()


@pytest.mark.parametrize(
    ("line", "place"),
    [('only = ["b_msgs"]', "7:1"), ('options = { titel = "x" }', "7:13"), ("options.source = 1", "7:9")],
)
def test_an_error_is_at_the_key(ifgen: Run, line: str, place: str) -> None:
    _project(line)
    assert f"pyproject.toml:{place}" in ifgen("generate").err
