"""Which codec runs, and why: what this Python is, what is installed, and what the user asks for."""

from __future__ import annotations

import importlib.util
import json
import os
import re
import subprocess
import sys
from functools import cache
from pathlib import Path
from types import ModuleType

import ifgen_native
import pytest
from ifgen_runtime.codec import choice

from .support import ROOT

choose = choice.chosen.__wrapped__
BOTH_CODECS = """
from geometry_msgs.msg import Point, Polygon, Point32
from ifgen_runtime import deserialize, serialize
from ifgen_runtime.codec.choice import chosen
import copy
polygon = Polygon(points=[Point32(x=0.5, y=0.25), Point32()])
data = serialize(polygon)
same = deserialize(data, Polygon)
assert same == polygon and copy.deepcopy(polygon) == copy.copy(polygon) == polygon and data == serialize(same)
assert deserialize(serialize(Point(x=0.1)), Point).x == 0.1
print(chosen().name, chosen().reason, sep=": ", end="")
"""


def test_the_user_chooses(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("IFGEN_CODEC", "python")
    assert (choose().name, choose().reason) == ("Python", "IFGEN_CODEC=python")
    for value in ("", "native"):
        monkeypatch.setenv("IFGEN_CODEC", value)
        assert (choose().name, choose().reason) == ("C", "ifgen_native is installed")
    monkeypatch.setenv("IFGEN_CODEC", "fast")
    with pytest.warns(
        RuntimeWarning, match="IFGEN_CODEC='fast' is not known and ignored; it can be native or python"
    ):
        assert choose().name == "C"


def reason() -> str:
    choice = choose()
    assert choice.name == "Python" and choice.extension is None
    return choice.reason


def test_pythons_that_cannot_have_it(monkeypatch: pytest.MonkeyPatch) -> None:
    with monkeypatch.context() as patch:
        patch.setattr(sys, "abiflags", "t")
        assert reason() == "free-threaded builds of Python are not supported"
    with monkeypatch.context() as patch:
        patch.setattr(sys.implementation, "name", "pypy")
        assert reason() == "ifgen_native is for CPython, and this is pypy"


def test_extensions_that_do_not_fit(monkeypatch: pytest.MonkeyPatch) -> None:
    with monkeypatch.context() as patch:
        patch.setattr(choice, "_ABI", 99)
        assert re.fullmatch(
            r"ifgen_native has version \d+ of the codec and .* 99: install the same release .*", reason()
        )
    with monkeypatch.context() as patch:
        patch.setitem(sys.modules, "ifgen_native", None)
        assert reason() == "ifgen_native is not installed"
        patch.setenv("IFGEN_CODEC", "native")
        with pytest.warns(
            RuntimeWarning, match="IFGEN_CODEC=native, but the codec in C cannot run: ifgen_native is"
        ):
            reason()
    with monkeypatch.context() as patch:
        patch.setattr(ifgen_native, "_native", ModuleType("_native"))
        patch.setitem(sys.modules, "ifgen_native._native", ModuleType("_native"))
        assert reason() == "this release of ifgen_native has no codec: install a newer one"


@cache
def pythons() -> list[str]:
    """A CPython of each version that this machine has and the limited API serves, this one first."""
    folders = [Path(entry) for entry in os.get_exec_path()] + sorted(
        Path.home().glob(".pyenv/versions/*/bin")
    )
    found: dict[int, str] = {sys.version_info.minor: sys.executable}
    for minor in range(11, 20):
        for path in (folder / f"python3.{minor}" for folder in folders):
            if minor not in found and path.is_file() and _is_cpython(path):
                found[minor] = str(path)
    return list(found.values())


def _is_cpython(path: Path) -> bool:
    command = [path, "-c", "import sys; print(sys.implementation.name, sys.abiflags)"]
    try:
        ran = subprocess.run(command, capture_output=True, text=True, check=False, timeout=60)
    except OSError:
        return False
    return ran.stdout == "cpython \n"


@pytest.fixture
def environment(tmp_path: Path) -> dict[str, str]:
    """What another Python finds: our packages, the runtime and the extension as it is installed here."""
    spec = importlib.util.find_spec("ifgen_native")
    assert spec is not None and spec.origin is not None
    (tmp_path / "ifgen_native").symlink_to(Path(spec.origin).parent)
    folders = (tmp_path, ROOT / "generated", ROOT / "codegen")
    kept = {name: value for name, value in os.environ.items() if not name.startswith(("PYTHON", "IFGEN"))}
    return {
        **kept,
        "PYTHONPATH": os.pathsep.join(map(str, folders)),
        "PYTHONPYCACHEPREFIX": str(tmp_path / "cache"),
    }


@pytest.mark.parametrize("python", pythons())
def test_one_extension_serves_every_python(python: str, environment: dict[str, str]) -> None:
    ran = subprocess.run(
        [python, "-c", BOTH_CODECS], env=environment, capture_output=True, text=True, timeout=60, check=False
    )
    assert (ran.stdout, ran.returncode) == ("C: ifgen_native is installed", 0), ran.stderr


IN_A_SUBINTERPRETER = """
try:
    import _interpreters as interpreters
except ImportError:
    import _xxsubinterpreters as interpreters
code = '''
import sys
print(end="", flush=True)
{code}
sys.stdout.flush()
'''
{before}
which = interpreters.create({arguments})
failed = interpreters.run_string(which, code)
assert not failed, failed
interpreters.destroy(which)
"""


@pytest.mark.parametrize("python", pythons())
@pytest.mark.parametrize(
    "before", ["", BOTH_CODECS.replace("print(", "(lambda *a, **b: None)(")], ids=["fresh", "after C"]
)
def test_subinterpreters_have_the_other(python: str, before: str, environment: dict[str, str]) -> None:
    """Objects of one interpreter must not reach another through what C remembers."""
    code = IN_A_SUBINTERPRETER.format(code=BOTH_CODECS, before=before, arguments="")
    ran = subprocess.run(
        [python, "-c", code], env=environment, capture_output=True, text=True, timeout=60, check=False
    )
    assert ran.returncode == 0, ran.stderr
    cannot = "ifgen_native cannot be loaded: module .*_native does not support loading in subinterpreters"
    assert re.fullmatch(f"Python: (this is a sub-interpreter|{cannot})", ran.stdout)


def test_nothing_but_the_limited_api() -> None:
    """abi3audit knows what each version of CPython promises: it stands for those that are not here."""
    audit = Path(sys.executable).with_name("abi3audit")
    spec = importlib.util.find_spec("ifgen_native._native")
    if not audit.exists() or spec is None or spec.origin is None:
        pytest.skip("needs abi3audit and the extension")
    command = [audit, "--strict", "--assume-minimum-abi3", "3.11", "--report", spec.origin]
    ran = subprocess.run(command, capture_output=True, text=True, timeout=100, check=False)
    assert ran.returncode == 0, ran.stdout + ran.stderr
    result = json.loads(ran.stdout)["specs"][spec.origin]["object"]["result"]
    assert result["is_abi3"] and not result["non_abi3_symbols"] and not result["future_abi3_objects"], result
