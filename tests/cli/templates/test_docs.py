"""docs/templates.md describes everything that exists."""

from __future__ import annotations

import re
import shutil
from dataclasses import fields, is_dataclass
from pathlib import Path

import pytest
from ifgen import model
from ifgen.generator_py.outputs import plan
from ifgen.generator_py.templates.table import OUTPUT_VARIABLES

from ..conftest import Run, write

TEXT = (Path(__file__).parents[3] / "docs/templates.md").read_text()
MODEL = (Path(__file__).parents[3] / "docs/model.md").read_text()
CLASSES = [value for value in vars(model).values() if isinstance(value, type) and is_dataclass(value)]


@pytest.mark.parametrize("cls", CLASSES)
def test_every_attribute_is_described(cls: type) -> None:
    for field in fields(cls):
        described = any(f"`{field.name}`" in text for text in (TEXT, MODEL, cls.__doc__ or ""))
        assert described or f'"{field.name}": ' in MODEL, f"{cls.__name__}.{field.name}"


def test_keys_fields_and_variables() -> None:
    for key in ("template", "path", "per", "only"):
        assert f"`{key}`" in TEXT
    for per, names in plan.FIELDS.items():
        [row] = [line for line in TEXT.splitlines() if line.startswith(f"| `{per}` | ") and "Package" in line]
        assert all(f"`{{{name}}}`" in row or "and " in row for name in names)
        assert all(f"`{name}`" in row for name in OUTPUT_VARIABLES[per] if name not in {"model", "options"})


def test_the_shown_error_is_what_is_printed(ifgen: Run, tmp_path: Path) -> None:
    write(
        tmp_path / "templates/message_package/message.j2",
        '{% extends "ifgen/message_package/message.j2" %}\n{% block additions %}\n'
        "{% for field in message.feilds %}\n{% endfor %}\n{% endblock %}\n",
    )
    shown = re.search(r"^error\[unknown-attribute\].*?(?=^```)", TEXT, re.MULTILINE | re.DOTALL)
    assert shown is not None
    assert ifgen("templates", "check", "templates").out == shown[0]


def test_the_examples_in_it_work(ifgen: Run, tmp_path: Path) -> None:
    blocks = re.findall(r"^```(\w+)\n(.*?)^```", TEXT, re.MULTILINE | re.DOTALL)
    code = dict(reversed(blocks))
    in_python = next(text for _, text in blocks if "import ifgen" in text)
    write(
        tmp_path / "pyproject.toml",
        code["toml"].replace("[tool.ifgen]\n", '[tool.ifgen]\npaths = ["a_msgs"]\n'),
    )
    write(tmp_path / "filters.py", code["python"])
    write(tmp_path / "a_msgs/msg/PointCloud2.msg", "float64 x\nfloat64 y\n")
    write(
        tmp_path / "templates/reference.md.j2",
        "{{ interface.name|shout }}{{ COMPANY }}{{ 'LongName'|snake }}\n",
    )
    mixin = code["jinja"].replace("MyMixin, ", "")
    write(tmp_path / "templates/message_package/message.j2", mixin)
    done = ifgen("generate")
    assert (done.code, done.err) == (0, "")
    assert Path("generated/docs/a_msgs/point_cloud2.md").read_text() == "POINTCLOUD2Acmelong_name\n"
    assert "return (self.x, self.y, )" in Path("generated/a_msgs/msg/_point_cloud2.py").read_text()
    from_python = {"Path": Path}
    shutil.rmtree("generated")
    exec(in_python.replace('"interfaces"', '"a_msgs"'), from_python)
    assert Path("generated/docs/a_msgs/point_cloud2.md").read_text() == "POINTCLOUD2Acmelong_name\n"
