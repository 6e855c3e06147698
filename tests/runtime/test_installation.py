"""The advice on what to install depends on how ifgen was installed; tests/packaging/test_advice.py runs it."""

from __future__ import annotations

import json
import shlex
import sys
from pathlib import Path

import pytest
from ifgen_runtime import installation

COMMIT = "0123456789abcdef0123456789abcdef01234567"


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder, the only one that is searched for metadata."""
    place = tmp_path / "it's here"
    place.mkdir()
    monkeypatch.setattr(sys, "path", [str(place)])
    return place


def installed(here: Path, name: str, record: object = None, installer: str = "pip") -> None:
    folder = here / f"{name.replace('-', '_')}-0.1.0.dist-info"
    folder.mkdir()
    (folder / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {name}\nVersion: 0.1.0\n")
    (folder / "INSTALLER").write_text(f"{installer}\n")
    if record is not None:
        (folder / "direct_url.json").write_text(json.dumps(record))


@pytest.fixture
def published(monkeypatch: pytest.MonkeyPatch) -> None:
    """As after our first release to an index."""
    monkeypatch.setattr(installation, "PUBLISHED", True)


def words(command: str) -> list[str]:
    """The arguments for pip to install."""
    found = shlex.split(command)
    return found[found.index("install") + 1 :]


def test_from_a_folder_of_wheels(here: Path) -> None:
    """No index has ours yet: advice names the folder, and exactly our version, which a stranger's is not."""
    installed(here, "ifgen-ros")
    links = ["--find-links", "FOLDER"]
    assert words(installation.add_extra("ros")) == [*links, "ifgen-ros[ros]==0.1.0"]
    assert words(installation.add_native()) == [*links, "ifgen-ros-native==0.1.0"]
    assert words(installation.add_runtime()) == [*links, "ifgen-ros-runtime==0.1.0"]
    assert words(installation.add_toolkit()) == [*links, "ifgen-ros==0.1.0"]
    assert installation.origin() == "from a folder of wheels: no index has ifgen yet"


def test_from_an_index(here: Path, published: None) -> None:
    installed(here, "ifgen-ros")
    assert words(installation.add_extra("ros")) == ["ifgen-ros[ros]"]
    assert words(installation.add_native()) == ["ifgen-ros-native==0.1.0"]
    assert words(installation.add_runtime()) == ["ifgen-ros-runtime==0.1.0"]
    assert installation.origin() == "from a package index"


@pytest.mark.parametrize("editable", [False, True])
def test_from_a_checkout(here: Path, editable: bool) -> None:
    installed(here, "ifgen-ros", {"dir_info": {"editable": editable}, "url": here.as_uri()})
    option = ["--editable"] if editable else []
    assert words(installation.add_extra("sim")) == [*option, f"{here}[sim]"]
    assert words(installation.add_extra("ros")) == [f"{here}/codegen/native", *option, f"{here}[ros]"]
    assert words(installation.add_native()) == [f"{here}/codegen/native"]
    assert words(installation.add_runtime()) == [*option, f"{here}/codegen/runtime"]
    assert str(here) in installation.origin()


def test_on_a_robot(here: Path) -> None:
    runtime = here / "codegen" / "runtime"
    runtime.mkdir(parents=True)
    installed(here, "ifgen-ros-runtime", {"dir_info": {}, "url": runtime.as_uri()})
    assert words(installation.add_extra("ros")) == [f"{here}/codegen/native", f"{runtime}[ros]"]
    assert words(installation.add_native()) == [f"{here}/codegen/native"]


def test_a_checkout_that_is_gone(here: Path, published: None) -> None:
    installed(here, "ifgen-ros", {"dir_info": {}, "url": (here / "gone").as_uri()})
    assert words(installation.add_extra("ros")) == ["ifgen-ros[ros]"]


def test_from_a_wheel(here: Path) -> None:
    wheel = here / "ifgen_ros-0.1.0-py3-none-any.whl"
    wheel.touch()
    installed(here, "ifgen-ros", {"archive_info": {}, "url": wheel.as_uri()})
    assert words(installation.add_extra("ros")) == ["--find-links", str(here), f"{wheel}[ros]"]
    assert words(installation.add_native()) == ["--find-links", str(here), "ifgen-ros-native==0.1.0"]


def test_from_a_web_server(here: Path) -> None:
    url = "https://example.com/ifgen_ros-0.1.0-py3-none-any.whl"
    installed(here, "ifgen-ros", {"archive_info": {}, "url": url})
    assert words(installation.add_extra("ros")) == [f"ifgen-ros[ros] @ {url}"]


def test_from_a_repository(here: Path) -> None:
    url = "https://example.com/ifgen.git"
    vcs = {"vcs": "git", "commit_id": COMMIT}
    installed(here, "ifgen-ros", {"url": url, "vcs_info": vcs})
    native = f"ifgen-ros-native @ git+{url}@{COMMIT}#subdirectory=codegen/native"
    assert words(installation.add_extra("ros")) == [native, f"ifgen-ros[ros] @ git+{url}@{COMMIT}"]
    assert words(installation.add_native()) == [native]
    assert installation.origin() == f"from {url} at {COMMIT[:12]}"


def test_on_the_path_only(here: Path, published: None) -> None:
    assert words(installation.add_extra("ros")) == ["ifgen-ros[ros]"]
    assert installation.origin() == "not installed, only on sys.path"


def test_pip_is_that_of_this_environment(
    here: Path, published: None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    installed(here, "ifgen-ros")
    monkeypatch.setenv("PATH", str(tmp_path))
    assert installation.add_extra("ros") == f"{shlex.quote(sys.executable)} -m pip install 'ifgen-ros[ros]'"
    monkeypatch.setenv("PATH", str(Path(sys.executable).parent))
    assert installation.add_extra("ros") == "pip install 'ifgen-ros[ros]'"


def test_uv(here: Path, published: None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    installed(here, "ifgen-ros", installer="uv")
    (tmp_path / "uv").touch(mode=0o755)
    monkeypatch.setenv("PATH", str(tmp_path))
    assert installation.add_extra("ros") == "uv pip install 'ifgen-ros[ros]'"
