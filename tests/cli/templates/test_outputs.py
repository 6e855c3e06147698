"""`[tool.ifgen.outputs]` and `filters`: a user's own files as part of the generated output."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest

from ..conftest import Run, write
from .conftest import PYPROJECT

ABOUT = Path("generated/a_msgs/about.txt")
INDEX = Path("generated/index.md")
DOC = Path("generated/docs/a_msgs/pose_stamped.md")


def files() -> set[str]:
    return {p.as_posix() for p in Path("generated").rglob("*") if p.is_file() and p.suffix in {".md", ".txt"}}


def test_each_kind_at_its_path(ifgen: Run, project: Path) -> None:
    assert ifgen("generate").code == 0
    assert DOC.read_text() == "POSESTAMPED of a_msgs\n"
    assert ABOUT.read_text() == "PoseStamped Move\n"
    assert INDEX.read_text() == "* a_msgs\n* b_msgs\n"
    assert files() == {
        *("generated/a_msgs/about.txt", "generated/b_msgs/about.txt", "generated/index.md"),
        *(
            "generated/docs/a_msgs/move.md",
            "generated/docs/a_msgs/pose_stamped.md",
            "generated/docs/b_msgs/pair.md",
        ),
    }
    assert ifgen("generate").out == "generated: up to date (16 files)\n"
    assert ifgen("generate", "--check").code == 0


@pytest.mark.parametrize(
    ("file", "text"),
    [
        ("templates/doc.md.j2", "{{ interface.name }}\n"),
        ("filters.py", "def shout(text: str) -> str:\n    return text + '!'\n"),
        ("pyproject.toml", PYPROJECT.replace("docs/{package}", "docs/of_{package}")),
        ("interfaces/a_msgs/msg/New.msg", "int8 x\n"),
        ("generated/index.md", "edited\n"),
        ("generated/docs/a_msgs/move.md", "edited\n"),
        ("generated/a_msgs/about.txt", "edited\n"),
    ],
)
def test_every_change_is_noticed(ifgen: Run, project: Path, file: str, text: str) -> None:
    ifgen("generate")
    write(project / file, text)
    assert ifgen("generate", "--check").code == 1
    assert "written" in ifgen("generate").out
    assert ifgen("generate", "--check").code == 0
    assert "up to date" in ifgen("generate").out


def test_what_is_made_once_counts_once(ifgen: Run, project: Path) -> None:
    """Also in a run that has been asked for something else, so that it renders again what has not changed."""
    ifgen("generate")
    assert ifgen("generate", "--with-deps=own").out == "generated: up to date (16 files)\n"


def test_what_is_generated_no_longer_goes(ifgen: Run, project: Path) -> None:
    ifgen("generate")
    (project / "interfaces/a_msgs/srv/Move.srv").unlink()
    assert "removed generated/docs/a_msgs/move.md\n" in ifgen("generate").out
    assert ABOUT.read_text() == "PoseStamped\n"
    shutil.rmtree(project / "interfaces/b_msgs")
    assert "removed generated/docs/b_msgs/pair.md\n" in ifgen("generate").out
    assert INDEX.read_text() == "* a_msgs\n"
    assert not Path("generated/docs/b_msgs").exists()
    write(project / "pyproject.toml", '[tool.ifgen]\npaths = ["interfaces"]\n')
    assert ifgen("generate").code == 0
    assert files() == set()
    assert not Path("generated/.ifgen-manifest.json").exists()


def test_an_edited_file_stays_when_its_output_goes(ifgen: Run, project: Path) -> None:
    ifgen("generate")
    INDEX.write_text("mine\n")
    write(project / "pyproject.toml", PYPROJECT.partition("[tool.ifgen.outputs.index]")[0])
    write(project / "templates/index.md.j2", "")
    (project / "templates/index.md.j2").unlink()
    done = ifgen("generate")
    assert "generated/index.md is no longer generated, but was edited: it stays" in done.err
    assert INDEX.read_text() == "mine\n"


def test_a_part_of_the_project_leaves_the_rest_alone(ifgen: Run, project: Path) -> None:
    ifgen("generate")
    write(project / "interfaces/b_msgs/msg/More.msg", "int8 x\n")
    done = ifgen("generate", "interfaces/b_msgs", "-I", "interfaces")
    assert done.code == 0
    assert Path("generated/docs/b_msgs/more.md").exists()
    assert DOC.exists()
    assert INDEX.read_text() == "* a_msgs\n* b_msgs\n"
    only_services = PYPROJECT.replace('per = "interface"', 'per = "interface"\nonly = ["*/srv/*"]')
    write(project / "pyproject.toml", only_services)
    assert ifgen("generate", "interfaces/b_msgs", "-I", "interfaces").code == 0, (
        "outputs may match nothing in a part"
    )


def test_only_picks_packages_and_interfaces(ifgen: Run, project: Path) -> None:
    text = PYPROJECT.replace('per = "interface"', 'per = "interface"\nonly = ["*/srv/*", "b_msgs"]')
    write(project / "pyproject.toml", text)
    ifgen("generate")
    assert {name for name in files() if "docs" in name} == {
        "generated/docs/a_msgs/move.md",
        "generated/docs/b_msgs/pair.md",
    }


def test_a_file_of_the_users_is_never_written_over(ifgen: Run, project: Path) -> None:
    write(INDEX, "mine\n")
    done = ifgen("generate")
    assert done.code == 1
    assert "generated/index.md is in the way: ifgen did not write it" in done.err
    assert not ABOUT.exists()


@pytest.mark.parametrize(
    ("before", "after", "said"),
    [
        ("{interface:snake}.md", "{interfac:snake}.md", "unknown field {interfac}"),
        ("{interface:snake}.md", "{interface:camel}.md", "{interface:snake} is one"),
        ("{interface:snake}.md", "{interface!r}.md", "{interface:snake} is one"),
        ("{interface:snake}.md", "{interface", "is not a pattern"),
        ("docs/{package}/{interface:snake}.md", "doc.md", "two of its files have the path 'doc.md'"),
        ("docs/{package}/{interface:snake}.md", "{package}/about.txt", "have the path 'a_msgs/about.txt'"),
        (
            "docs/{package}/{interface:snake}.md",
            "{package}/__init__.py",
            "have the path 'a_msgs/__init__.py'",
        ),
        ('path = "index.md"', 'path = "../index.md"', "outside the output folder"),
        ('path = "index.md"', 'path = "/index.md"', "outside the output folder"),
        ('path = "index.md"', 'path = "a//index.md"', "not the plain path of a file"),
        ('path = "index.md"', 'path = ""', "not the plain path of a file"),
        ('path = "index.md"', 'path = ".ifgen-manifest.json"', "ifgen's own list"),
        ('path = "index.md"', 'path = "a_msgs/__init__.py"', "in the folder of another package, a_msgs"),
        ('path = "index.md"', 'path = "{package}.md"', "an output per run has no fields"),
        ('template = "index.md.j2"', 'template = "indx.md.j2"', "did you mean index.md.j2?"),
        (
            'per = "package"',
            'per = "node"\nonly = ["a_msgs"]',
            "it matches nothing: there is no node that `only` matches",
        ),
        ('per = "package"', 'per = "package"\nonly = ["c_msgs", "a_msgs"]', "'c_msgs' matches nothing"),
        ('per = "run"', 'per = "always"', "'per' in [tool.ifgen.outputs.index] must be"),
        ('per = "run"\n', "", "[tool.ifgen.outputs.index] needs a 'per'"),
        ('per = "run"', 'per = "run"\npre = 1', "did you mean 'per'?"),
    ],
)
def test_mistakes_in_outputs(ifgen: Run, project: Path, before: str, after: str, said: str) -> None:
    assert before in PYPROJECT
    write(project / "pyproject.toml", PYPROJECT.replace(before, after))
    done = ifgen("generate")
    assert done.code in {1, 2}
    assert said in " ".join(done.err.split())
    assert "pyproject.toml:" in done.err or "in the way" in done.err
    checked = ifgen("templates", "check")
    assert checked.code in {1, 2}
    assert said in " ".join((checked.out + checked.err).split())
    assert not Path("generated").exists()


def test_check_renders_what_looks_right(ifgen: Run, project: Path) -> None:
    write(project / "filters.py", "def shout(text: str) -> str:\n    return text.up()\n")
    done = ifgen("templates", "check")
    assert done.code == 1
    assert "filters.py:2" in done.out
    assert "has no attribute 'up'" in done.out
    assert not Path("generated").exists()


def test_check_leaves_mistakes_in_interfaces_to_others(ifgen: Run, project: Path) -> None:
    write(project / "interfaces/b_msgs/msg/Pair.msg", "nonsense\n")
    assert ifgen("templates", "check").out == "templates: no mistakes\n"
    write(project / "pyproject.toml", PYPROJECT.replace('path = "index.md"', 'path = "../index.md"'))
    assert "outside the output folder" in ifgen("templates", "check").out


@pytest.mark.parametrize(
    ("text", "place", "said"),
    [
        ("def shout(text: str) -> str:\n    return text.nonsense()\n", "2:5", "AttributeError"),
        ("def shout(text):\n    return 1 / 0\n", "2:5", "ZeroDivisionError: division by zero"),
        ("x = 1\ndef shout(text)\n", "2:1", "expected ':'"),
        ("import nonsense\n", "1:1", "No module named 'nonsense'"),
        ("raise SystemExit(3)\n", "1:1", "SystemExit: 3"),
        ("def upper(text):\n    return text\n", "1:1", "there is a filter 'upper' already"),
        ("def is_defined(text):\n    return text\n", "1:1", "there is a test 'defined' already"),
        ("def shouts(text):\n    return text\n", "templates/doc.md.j2:1:19", "did you mean 'shouts'?"),
        (
            "def shout(text: str, times: int) -> str:\n    return text\n",
            "templates/doc.md.j2:1:19",
            "missing a required",
        ),
    ],
)
def test_mistakes_in_filters(ifgen: Run, project: Path, text: str, place: str, said: str) -> None:
    write(project / "filters.py", text)
    done = ifgen("generate")
    assert done.code == 1
    assert place in done.err
    assert said in done.err
    assert not Path("generated").exists()
    if "template-error" in done.err:
        assert "templates/doc.md.j2" in done.err, "the place that uses the filter is shown too"


def test_tests_and_names_come_from_filters_too(ifgen: Run, project: Path) -> None:
    write(
        project / "filters.py",
        "COMPANY = 'Acme'\ndef shout(t: str) -> str:\n    return t\ndef is_long(t: str) -> bool:\n    return len(t) > 5\n",
    )
    write(project / "templates/doc.md.j2", "{{ COMPANY }}{% if interface.name is long %} long{% endif %}!\n")
    assert ifgen("generate").code == 0
    assert DOC.read_text() == "Acme long!\n"
    assert Path("generated/docs/a_msgs/move.md").read_text() == "Acme!\n"
    assert not (project / "__pycache__").exists()


def test_the_manifest_names_what_lies_beside(ifgen: Run, project: Path) -> None:
    ifgen("generate")
    record = json.loads(Path("generated/a_msgs/.ifgen-manifest.json").read_text())
    assert set(record["beside"]) == {"docs/a_msgs/move.md", "docs/a_msgs/pose_stamped.md"}
    assert "about.txt" in record["files"]


def test_a_manifest_cannot_name_files_elsewhere(ifgen: Run, project: Path) -> None:
    ifgen("generate")
    path = Path("generated/a_msgs/.ifgen-manifest.json")
    path.write_text(path.read_text().replace("docs/a_msgs/move.md", "../../move.md"))
    done = ifgen("generate")
    assert done.code == 1
    assert "outside" in done.err


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("{% include 'doc.md.j2' if interface else 'doc.md.j2' %}", "includes itself without end"),
        ("{% if interface %}{% include 'doc.md.j2' %}{% endif %}", "RecursionError"),
        ("{% macro m() %}{% if interface %}{{ m() }}{% endif %}{% endmacro %}{{ m() }}", "RecursionError"),
        ("{% include interface.name %}", "TemplateNotFound: PoseStamped"),
        ("{{ interface.name[0:1:0] }}", "ValueError: slice step cannot be zero"),
        ("{{ 'x' * (1 / 0) }}", "ZeroDivisionError"),
        ("{{ interface|attr('nope') }}", "has no attribute 'nope'"),
        ("{{ interface.uses[0].name }}", "UndefinedError"),
        ("{{ '\\udc80' }}", "docs/a_msgs/pose_stamped.md cannot be written: '\\udc80' is not a character"),
        ("{% block a %}{% endblock %}{% block a %}{% endblock %}", "block 'a' defined twice"),
        ("{% extends interface.name %}", "TemplateNotFound"),
    ],
)
def test_templates_that_fail(ifgen: Run, project: Path, text: str, said: str) -> None:
    write(project / "templates/doc.md.j2", text + "\n")
    done = ifgen("generate")
    assert done.code == 1
    assert said in " ".join(done.err.split())
    assert "templates/doc.md.j2:1:" in done.err or "docs/a_msgs/pose_stamped.md cannot" in done.err
    assert not Path("generated").exists()


def test_files_that_are_no_templates(ifgen: Run, project: Path) -> None:
    (project / "templates/doc.md.j2").write_bytes(b"\xff\n")
    done = ifgen("generate")
    assert (done.code, "templates/doc.md.j2 is not UTF-8" in done.err) == (1, True)
    (project / "filters.py").write_bytes(b"\xff\n")
    done = ifgen("generate")
    assert (done.code, "filters.py cannot be read: it is not UTF-8" in done.err) == (1, True)
    (project / "filters.py").unlink()
    done = ifgen("generate")
    assert (done.code, "'filters' in [tool.ifgen] names" in done.err) == (2, True)
    (project / "filters.py").mkdir()
    done = ifgen("generate")
    assert (done.code, "filters.py cannot be read: Is a directory" in done.err) == (1, True)


def test_extending_oneself_is_explained(ifgen: Run, project: Path) -> None:
    name = "message_package/message.j2"
    write(project / "templates" / name, f'{{% extends "{name}" %}}\n')
    done = ifgen("generate")
    assert 'help: ifgen\'s own is "ifgen/message_package/message.j2"' in done.err


NODE = "nodl_version: 2\npublishers:\n  - {name: chatter, type: std_msgs/msg/String, qos: {history: KEEP_LAST, depth: 1, reliability: RELIABLE}}\n"


def test_packages_with_nodes(ifgen: Run, project: Path) -> None:
    write(project / "interfaces/robot/nodl/talker.nodl.yaml", NODE)
    text = PYPROJECT.replace('path = "{package}/about.txt"', 'path = "{import_folder}/about.txt"')
    text += (
        '[tool.ifgen.outputs.nodes]\ntemplate = "node.j2"\npath = "{package}/doc/{node}.txt"\nper = "node"\n'
    )
    write(project / "pyproject.toml", text)
    write(project / "templates/node.j2", "{{ node.publishers[0].full_name }} {{ node.node_class }}\n")
    assert ifgen("generate").code == 0
    assert Path("generated/robot/robot/about.txt").exists()
    assert ABOUT.exists()
    assert Path("generated/robot/doc/talker.txt").read_text() == "/chatter Talker\n"
    assert INDEX.read_text() == "* a_msgs\n* b_msgs\n* robot\n"
    assert ifgen("generate", "--check").code == 0
    write(project / "interfaces/robot/nodl/talker.nodl.yaml", NODE.replace("chatter", "news"))
    assert ifgen("generate").code == 0
    assert Path("generated/robot/doc/talker.txt").read_text() == "/news Talker\n"
    (project / "interfaces/robot/nodl/talker.nodl.yaml").rename(
        project / "interfaces/robot/nodl/walker.nodl.yaml"
    )
    assert "removed generated/robot/doc/talker.txt\n" in ifgen("generate").out


def test_an_output_in_the_place_of_a_users_node(ifgen: Run, project: Path) -> None:
    write(project / "interfaces/robot/nodl/talker.nodl.yaml", NODE)
    text = PYPROJECT.replace('path = "{package}/about.txt"', 'path = "{import_folder}/talker.py"')
    write(project / "pyproject.toml", text)
    write(project / "templates/about.txt.j2", "")
    done = ifgen("generate")
    assert (
        done.code,
        "ifgen writes its own file at 'robot/robot/talker.py'" in " ".join(done.err.split()),
    ) == (1, True)
    assert not Path("generated").exists()


def test_an_output_that_is_no_python_names_the_line_of_its_template(ifgen: Run, project: Path) -> None:
    write(project / "templates/part.j2", "{% macro part(name) %}\ndef {{ name }}(\n{% endmacro %}\n")
    write(
        project / "templates/about.txt.j2",
        "{% from 'part.j2' import part %}\nx = 1\n{{ part(package.name) }}\ny = 2\n",
    )
    write(project / "pyproject.toml", PYPROJECT.replace('about.txt"\nper', 'about.py"\nper'))
    done = ifgen("generate")
    assert done.code == 1 and not Path("generated").exists()
    assert (
        "error[broken-output]: template part.j2 makes a broken file: about.py:2: '(' was never"
        in " ".join(done.err.replace("a_msgs/", "").split())
    )
    assert "--> templates/part.j2:2:1\n" in done.err
    assert "the line in the file is `def a_msgs(`" in done.err


def test_an_error_points_to_the_key(ifgen: Run, project: Path) -> None:
    write(project / "pyproject.toml", PYPROJECT.replace("{package}/about.txt", "{pakage}/about.txt"))
    line = PYPROJECT.splitlines().index('path = "{package}/about.txt"') + 1
    assert f"--> pyproject.toml:{line}:1\n" in ifgen("generate").err


def test_line_breaks_that_a_tag_takes_away(ifgen: Run, project: Path) -> None:
    write(
        project / "templates/index.md.j2", "# All\n{%- for p in packages %}\n* {{ p.name }}\n{%- endfor %}\n"
    )
    done = ifgen("templates", "check")
    assert (
        done.code == 0
        and "warning[trimmed-line]: `{%-` removes the line break before it\n --> templates/index.md.j2:2:1"
        in done.out
    )
    write(
        project / "templates/index.md.j2",
        "{% for p in packages %}\n{%- if true %}\n* {{ p.name }}\n{% endif %}\n{% endfor %}\n",
    )
    assert ifgen("templates", "check").out == "templates: no mistakes\n"


def test_templates_in_an_installed_package(
    ifgen: Run, project: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (project / "templates").rename(write(project / "site/acme_theme/__init__.py", "").parent / "templates")
    monkeypatch.syspath_prepend(project / "site")
    write(project / "pyproject.toml", PYPROJECT.replace('"templates"', '"package:acme_theme/templates"'))
    assert ifgen("generate").code == 0 and Path("generated/index.md").exists()
    write(project / "pyproject.toml", PYPROJECT.replace('"templates"', '"package:acme_them/templates"'))
    assert "names package:acme_them/templates, which does not exist" in ifgen("generate").err


def test_json_in_a_template(ifgen: Run, project: Path) -> None:
    write(
        project / "templates/index.md.j2",
        "{{ model|tojson }}\n{{ packages[0].interfaces[0].messages[0]|tojson }}\n",
    )
    assert ifgen("generate").code == 0
    whole, message = map(json.loads, Path("generated/index.md").read_text().splitlines())
    assert message in whole["types"]
