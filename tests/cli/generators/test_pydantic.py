"""The generator `pydantic`: models whose fields and classes have the names of what models need themselves."""

from __future__ import annotations

import builtins
import re
import subprocess
import sys
from pathlib import Path

import pytest

from ..conftest import Run, write

pydantic = pytest.importorskip("pydantic")
WORD = re.compile("[a-z][a-z0-9]*(_[a-z0-9]+)*")
FIELDS = sorted(
    name
    for name in {
        *dir(builtins),
        *dir(pydantic.BaseModel),
        *dir(pydantic),
        "cls",
        "date",
        "message",
        "self",
        "typing",
    }
    if WORD.fullmatch(name)
)
TYPES = (
    *("float64", "int32", "bool", "byte", "string", "wstring<=4", "n_msgs/Point", "float64[]", "int32[<=3]"),
    *("bool[2]", "byte[]", "uint8[4]", "string[]", "n_msgs/Point[]", "n_msgs/Point[2]"),
)
CLASSES = (
    *("Annotated", "Any", "BaseModel", "ClassVar", "ConfigDict", "Dict", "Field", "Float", "Int", "List"),
    *("Message", "Self", "String", "Type"),
)
TRY = """
import importlib, sys, warnings
from pathlib import Path

warnings.simplefilter("error")
sys.path[:0] = [".", "generated"]
for path in sorted(Path("message_models/n_msgs/msg").glob("[a-z]*.py")):
    module = importlib.import_module(f"message_models.n_msgs.msg.{path.stem}")
    for name in module.__all__:
        model = getattr(module, name)
        new = model()
        assert model.from_message(new.to_message()) == new == new.model_copy(), name
        text = new.model_dump_json(by_alias=True)
        assert model.model_validate_json(text) == new, name
        assert set(model.model_json_schema()["properties"]) == set(new.to_message().get_fields_and_field_types())
        print(name)
"""


@pytest.mark.slow
def test_every_name_that_a_model_needs(ifgen: Run, tmp_path: Path) -> None:
    for number, type_ in enumerate(TYPES):
        write(Path(f"n_msgs/msg/Names{number}.msg"), "".join(f"{type_} {name}\n" for name in FIELDS))
    write(Path("n_msgs/msg/Point.msg"), "float64 x\n")
    for name in CLASSES:
        text = "float64 x\nint32[] values\nstring[<=3] s\nuint8 A=1\nn_msgs/Point p\nint32 int\n"
        write(Path(f"n_msgs/msg/{name}.msg"), text)
    users = "".join(
        f"n_msgs/{name} {name.lower()}\nn_msgs/{name}[] many_{name.lower()}\n" for name in CLASSES
    )
    write(Path("n_msgs/msg/Users.msg"), users)
    write(
        Path("pyproject.toml"),
        '[tool.ifgen]\npaths = ["n_msgs"]\n'
        '[tool.ifgen.generate.models]\nuse = "pydantic"\nout = "message_models"\n',
    )
    assert ifgen("generate").code == 0
    done = subprocess.run(
        [sys.executable, "-c", TRY], capture_output=True, text=True, timeout=200, check=False
    )
    assert done.returncode == 0, done.stderr
    assert len(done.stdout.split()) == len(TYPES) + len(CLASSES) + 2
