"""`ifgen templates list`, `export`, `diff`, `check` and `context`."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from ifgen import resources
from ifgen.generator_py.templates import catalogue
from ifgen.generator_py.templates.table import OUTPUT_VARIABLES, TEMPLATES
from ifgen.model import Interface, Package
from pydantic import TypeAdapter

from ..conftest import Run, write

MESSAGE = "message_package/message.j2"


@pytest.fixture
def older(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder in place of ifgen's templates, so that they can change."""
    folder = tmp_path / "ifgens"
    write(folder / MESSAGE, "one\ntwo\nthree\nfour\nfive\n")
    write(folder / "message_package/codec.j2", "codec\n")
    monkeypatch.setattr(resources, "templates", lambda: folder)
    return folder


def test_list_names_what_there_is(ifgen: Run, project: Path) -> None:
    everything = ifgen("templates", "list")
    assert everything.code == 0
    assert all(name in everything.out.splitlines() for name in TEMPLATES)
    assert max(map(len, everything.out.splitlines())) <= 80
    write(project / "templates" / MESSAGE, '{% extends "ifgen/message_package/message.j2" %}')
    assert ifgen("templates", "list", MESSAGE, "doc.md.j2").out == (
        "message_package/message.j2\n"
        "  given   module: InterfaceModule, message: MessageClass\n"
        "  part of message_package/interface.py.j2\n"
        "  blocks  metaclass, bases, docstring, attributes, views, additions\n"
        "  yours   templates/message_package/message.j2\n"
        "\n"
        "doc.md.j2\n"
        "  makes   docs/{package}/{interface:snake}.md, output 'docs'\n"
        "  given   interface: Interface, package: Package, model: Model, options:\n"
        "          Mapping[str, Any]\n"
        "  yours   templates/doc.md.j2\n"
    )
    assert ifgen("templates", "list", "message_package").out.count("\n\n") > 5


def test_every_template_of_ours_is_in_the_table_or_a_part() -> None:
    folder = resources.templates()
    names = {path.relative_to(folder).as_posix() for path in folder.rglob("*.j2")}
    parts = names - TEMPLATES.keys()
    texts = {name: (folder / name).read_text() for name in names}
    assert TEMPLATES.keys() <= names
    for part in parts:
        assert any(f'"{part}"' in text for name, text in texts.items() if name != part), part


@pytest.mark.parametrize("command", ["list", "export"])
def test_unknown_names(ifgen: Run, project: Path, command: str) -> None:
    done = ifgen("templates", command, "mesage_package")
    assert (done.code, "did you mean message_package?" in done.err) == (2, True)


def test_export_and_generate(ifgen: Run, project: Path) -> None:
    assert ifgen("templates", "export", MESSAGE).out == f"exported templates/{MESSAGE}\n"
    assert (project / "templates" / MESSAGE).read_text() == (resources.templates() / MESSAGE).read_text()
    assert ifgen("templates", "export", "message_package").out.endswith("templates: 1 exported already\n")
    assert ifgen("generate").code == 0, "what is exported works as it is"
    assert ifgen("templates", "check").out == "templates: no mistakes\n"
    write(project / "templates" / MESSAGE, "mine\n")
    done = ifgen("templates", "export", MESSAGE)
    assert (done.code, "templates/message_package/message.j2 is in the way" in done.err) == (1, True)
    assert (project / "templates" / MESSAGE).read_text() == "mine\n"
    assert ifgen("templates", "export", "all", "elsewhere").code == 0
    exported = {
        p.relative_to("elsewhere").as_posix()
        for p in Path("elsewhere").rglob("*.j2")
        if ".ifgen" not in str(p)
    }
    assert exported >= TEMPLATES.keys()


def test_export_says_how_templates_come_into_use(ifgen: Run, project: Path) -> None:
    next_ = 'next: `templates = "mine"` in [tool.ifgen] of pyproject.toml, so that they are used\n'
    assert ifgen("templates", "export", MESSAGE, "mine").out == f"exported mine/{MESSAGE}\n{next_}"
    text = (project / "pyproject.toml").read_text()
    write(project / "pyproject.toml", text.replace('"templates"', '"mine"'))
    assert "next:" not in ifgen("templates", "export", MESSAGE, "mine").out


@pytest.mark.parametrize("options", [(), ("--extend",)])
def test_exporting_everything_changes_nothing(ifgen: Run, project: Path, options: tuple[str, ...]) -> None:
    write(
        project / "interfaces/robot/nodl/talker.nodl.yaml",
        "nodl_version: 2\ncodegen: {ifgen: {style: asyncio}}\nparameters:\n  speed: {type: double, default_value: 1.5}\n"
        "service_servers:\n  - {name: move, type: a_msgs/srv/Move}\n",
    )
    assert ifgen("generate", "--tests").code == 0
    assert ifgen("templates", "export", "all", *options).code == 0
    assert ifgen("templates", "check").out == "templates: no mistakes\n"
    done = ifgen("generate", "--tests", "--check")
    assert (done.code, done.out) == (0, "generated: up to date\n")


def test_export_what_builds_on_ours(ifgen: Run, project: Path) -> None:
    ifgen("generate")
    before = Path("generated/a_msgs/msg/_pose_stamped.py").read_text()
    assert ifgen("templates", "export", "message_package", "--extend").code == 0
    text = (project / "templates" / MESSAGE).read_text()
    assert text.startswith(f'{{% extends "ifgen/{MESSAGE}" %}}\n')
    assert "{% block bases %}{{ super() }}{% endblock %}" in text
    assert ifgen("generate").code == 0
    assert Path("generated/a_msgs/msg/_pose_stamped.py").read_text() == before
    assert "message_package/message.j2: extends ifgen's\n" in ifgen("templates", "diff").out


def test_a_folder_is_needed(ifgen: Run, tmp_path: Path) -> None:
    done = ifgen("templates", "export", MESSAGE)
    assert (done.code, "no folder of templates" in done.err) == (2, True)
    assert ifgen("templates", "diff").code == 2
    assert ifgen("templates", "check").code == 2


def test_diff_and_merge(ifgen: Run, tmp_path: Path, older: Path) -> None:
    mine = tmp_path / "mine" / MESSAGE
    ifgen("templates", "export", "all", "mine")
    assert ifgen("templates", "diff", "mine").out == (
        "message_package/codec.j2: as exported\nmessage_package/message.j2: as exported\n"
    )
    write(mine, "one\nTWO\nthree\nfour\nfive\n")
    assert ifgen("templates", "diff", "mine").code == 0
    write(older / MESSAGE, "one\ntwo\nthree\nfour\nFIVE\n")
    done = ifgen("templates", "diff", "mine")
    assert done.code == 1
    assert "message_package/message.j2: changed in ifgen and by you: both can be merged\n" in done.out
    assert "-five\n+FIVE\n" in done.out
    assert "+++ mine/message_package/message.j2 (merged)" in done.out
    assert ifgen("templates", "diff", "mine", "--merge").code == 0
    assert mine.read_text() == "one\nTWO\nthree\nfour\nFIVE\n"
    assert "message.j2: changed by you\n" in ifgen("templates", "diff", "mine").out


def test_conflicts_are_marked(ifgen: Run, tmp_path: Path, older: Path) -> None:
    mine = tmp_path / "mine" / MESSAGE
    ifgen("templates", "export", MESSAGE, "mine")
    write(mine, "one\nmine\nthree\nfour\nfive\n")
    write(older / MESSAGE, "one\nours\nthree\nfour\nfive\n")
    assert "changed in ifgen and by you: 1 conflict\n" in ifgen("templates", "diff", "mine").out
    done = ifgen("templates", "diff", "mine", "--merge")
    assert (done.code, done.out) == (
        1,
        "CONFLICT in mine/message_package/message.j2\nmessage_package/message.j2: 1 conflict to resolve\n",
    )
    assert mine.read_text() == (
        "one\n<<<<<<< ifgen's template now\nours\n||||||| as it was exported\ntwo\n=======\nmine\n"
        ">>>>>>> your template\nthree\nfour\nfive\n"
    )
    assert ifgen("templates", "diff", "mine").code == 1
    checked = ifgen("templates", "check", "mine")
    assert checked.code == 1
    assert "mine/message_package/message.j2:2:1" in checked.out
    assert "this template has a conflict that is not resolved" in checked.out
    write(mine, "one\nmine\nthree\nfour\nfive\n")
    assert ifgen("templates", "diff", "mine").code == 0


def test_what_became_of_templates(ifgen: Run, tmp_path: Path, older: Path) -> None:
    ifgen("templates", "export", "all", "mine")
    (tmp_path / "mine" / MESSAGE).unlink()
    (older / "message_package/codec.j2").unlink()
    write(older / "message_package/new.j2", "new\n")
    write(tmp_path / "mine/message_package/new.j2", "mine\n")
    assert ifgen("templates", "diff", "mine").out.partition("\n\n")[0].rstrip("\n") == (
        "message_package/codec.j2: ifgen no longer has this template\n"
        "message_package/message.j2: you deleted it: ifgen's own is used\n"
        "message_package/new.j2: not exported, so changes in ifgen's cannot be found"
    )


def test_check_prints_as_the_other_check_does(ifgen: Run, project: Path) -> None:
    write(project / "templates/doc.md.j2", "{{ interface.nme }}\n{{ package.interfaces }}\n")
    done = ifgen("templates", "check")
    assert done.code == 1
    assert done.out == (
        "error[unknown-attribute]: an Interface has no 'nme'\n"
        " --> templates/doc.md.j2:1:14\n"
        "  |\n"
        "1 | {{ interface.nme }}\n"
        "  |              ^^^\n"
        "  = help: did you mean 'name'?\n"
        "\n"
        "warning[printed-value]: a tuple of Interface is printed as Python shows it\n"
        " --> templates/doc.md.j2:2:11\n"
        "  |\n"
        "2 | {{ package.interfaces }}\n"
        "  |           ^\n"
        "  = help: print its parts\n"
        "\n"
        "1 error, 1 warning\n"
    )
    assert json.loads(ifgen("templates", "check", "--format", "json").out)["errors"] == 1
    assert ifgen("templates", "check", "--format", "github").out.startswith("::error file=")
    write(project / "templates/doc.md.j2", "{{ package.interfaces }}\n")
    assert ifgen("templates", "check").code == 0, "warnings are no errors"
    assert ifgen("generate").code == 0


@pytest.mark.parametrize(
    "name", ["a_msgs/msg/PoseStamped", "a_msgs/PoseStamped", "a_msgs/srv/Move", "a_msgs/Move_Request"]
)
def test_context(ifgen: Run, project: Path, name: str) -> None:
    found = json.loads(ifgen("templates", "context", name, "--json").out)
    assert found["message_package/interface.py.j2"]["module"]["type_name"].startswith("a_msgs/")
    given = found["outputs per interface"]
    assert given["interface"]["package"] == given["package"]["name"] == "a_msgs"
    TypeAdapter(Interface).validate_python(given["interface"])
    text = ifgen("templates", "context", name).out
    assert "\n  interface: Interface\n" in text
    assert max(map(len, text.splitlines())) < 120


def test_context_of_a_node(ifgen: Run, project: Path) -> None:
    write(
        project / "interfaces/robot/nodl/talker.nodl.yaml",
        "nodl_version: 2\ndescription: Talks.\npublishers:\n  - name: chatter\n    type: std_msgs/msg/String\n"
        "    qos: {history: KEEP_LAST, depth: 3, reliability: RELIABLE}\n",
    )
    found = json.loads(ifgen("templates", "context", "robot/talker", "--json").out)
    node = found["outputs per node"]["node"]
    assert node["publishers"][0]["full_name"] == "/chatter"
    assert node["publishers"][0]["qos"]["depth"] == 3
    TypeAdapter(Package).validate_python(found["outputs per package"]["package"])
    assert found["node_package/base.py.j2"]["node"]
    done = ifgen("templates", "context", "robot/walker")
    assert (done.code, "there is no type 'robot/walker'" in done.err) == (2, True)
    assert ifgen("templates", "context").code == 2


def test_the_schema_describes_every_context(ifgen: Run, project: Path) -> None:
    schema = json.loads(ifgen("templates", "context", "--schema").out)
    assert schema == catalogue.schema()
    assert schema["properties"].keys() == {*TEMPLATES, *(f"outputs per {per}" for per in OUTPUT_VARIABLES)}
    for name, definition in schema["$defs"].items():
        assert definition.get("description"), name
    view = schema["$defs"]["Field"]
    assert view["properties"]["name"] == {"title": "Name", "type": "string"}
    assert set(view["required"]) == set(view["properties"])
