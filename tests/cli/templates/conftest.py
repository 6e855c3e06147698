"""A project with its own templates."""

from __future__ import annotations

from pathlib import Path

import pytest

from ..conftest import write

PYPROJECT = """\
[tool.ifgen]
paths = ["interfaces"]
templates = "templates"
filters = "filters.py"
tests = false

[tool.ifgen.outputs.docs]
template = "doc.md.j2"
path = "docs/{package}/{interface:snake}.md"
per = "interface"

[tool.ifgen.outputs.about]
template = "about.txt.j2"
path = "{package}/about.txt"
per = "package"

[tool.ifgen.outputs.index]
template = "index.md.j2"
path = "index.md"
per = "run"
"""


@pytest.fixture
def project(tmp_path: Path) -> Path:
    """Two packages, and an output of each kind that needs no nodes."""
    write(tmp_path / "pyproject.toml", PYPROJECT)
    write(tmp_path / "interfaces/a_msgs/msg/PoseStamped.msg", "# A pose.\nfloat64 x 1.5 # [m]\n")
    write(tmp_path / "interfaces/a_msgs/srv/Move.srv", "PoseStamped goal\n---\nbool ok\n")
    write(tmp_path / "interfaces/b_msgs/msg/Pair.msg", "a_msgs/PoseStamped[2] poses\n")
    write(tmp_path / "templates/doc.md.j2", "{{ interface.name|shout }} of {{ package.name }}\n")
    write(tmp_path / "templates/about.txt.j2", "{{ package.interfaces|map(attribute='name')|join(' ') }}\n")
    write(tmp_path / "templates/index.md.j2", "{% for p in packages %}\n* {{ p.name }}\n{% endfor %}\n")
    write(tmp_path / "filters.py", "def shout(text: str) -> str:\n    return text.upper()\n")
    return tmp_path
