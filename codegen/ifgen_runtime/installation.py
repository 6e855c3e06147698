"""The installation of this ifgen, and the commands that add to it.

The one place in the code that knows what the distributions are called. `ifgen` on an index is another
project: advice to install that would replace ours.
"""

from __future__ import annotations

import json
import os
import shlex
import shutil
import subprocess
import sys
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from importlib.metadata import PackageNotFoundError, distribution
from pathlib import Path
from typing import Any, Final
from urllib.parse import quote, urlsplit
from urllib.request import url2pathname

TOOLKIT: Final = "ifgen-ros"
RUNTIME: Final = "ifgen-ros-runtime"
NATIVE: Final = "ifgen-ros-native"

_FOLDERS: Final = {TOOLKIT: "", RUNTIME: "codegen/runtime", NATIVE: "codegen/native"}
"""The folder of each distribution in a checkout."""

PUBLISHED: Final = False
"""True once we have released to an index. Until then, whoever registers our names there is a stranger."""

_WHEELS: Final = "FOLDER"
"""Stands in advice for the folder with our wheels: no installer notes where `--find-links` pointed."""

_OF_URLS: Final = ":/@~?&=%"  # pip has decoded the rest


def add_extra(extra: str) -> str:
    """The command, quoted for a shell, that adds an extra such as `ros` to what is installed here."""
    base = _installed()
    # An index or a folder of wheels has the type support; for a repository its folder must be named.
    native = _requirement(NATIVE, base) if extra == "ros" and base.is_repository else []
    return _command(base, [*native, *_requirement(base.name, base, f"[{extra}]")])


def add_native() -> str:
    """The command, quoted for a shell, that adds the type support for real rclpy."""
    base = _installed()
    return _command(base, _requirement(NATIVE, base))


def add_runtime() -> str:
    """The command, quoted for a shell, that installs the runtime that belongs to what is installed here."""
    base = _installed()
    return _command(base, _requirement(RUNTIME, base))


def add_toolkit() -> str:
    """The command, quoted for a shell, that installs the toolkit that belongs to what is installed here."""
    base = _installed()
    return _command(base, _requirement(TOOLKIT, base))


def origin() -> str:
    """Its origin, in a few words."""
    base = _installed()
    if "vcs_info" in base.record:
        return f"from {base.url} at {base.record['vcs_info']['commit_id'][:12]}"
    if base.is_editable:
        return f"editable, from {base.path}"
    if base.url:
        return f"from {base.path or base.url}"
    if not base.version:
        return "not installed, only on sys.path"
    return "from a package index" if PUBLISHED else "from a folder of wheels: no index has ifgen yet"


@dataclass(frozen=True, slots=True)
class _Installed:
    """One of our distributions that is installed, with what its installer noted (PEP 610)."""

    name: str
    version: str = ""
    installer: str = ""
    record: Mapping[str, Any] = field(default_factory=dict[str, Any])

    @property
    def url(self) -> str:
        return str(self.record.get("url", ""))

    @property
    def path(self) -> Path | None:
        parts = urlsplit(self.url)
        return Path(url2pathname(parts.path)) if parts.scheme == "file" else None

    @property
    def is_repository(self) -> bool:
        return "vcs_info" in self.record or (self.path is not None and self.path.is_dir())

    @property
    def is_editable(self) -> bool:
        return bool(self.record.get("dir_info", {}).get("editable"))


def _installed() -> _Installed:
    """The toolkit where that is installed, else the runtime, as on a robot."""
    for name in (TOOLKIT, RUNTIME):
        with suppress(PackageNotFoundError):
            found = distribution(name)
            installer = (found.read_text("INSTALLER") or "").strip()
            record = json.loads(found.read_text("direct_url.json") or "{}")
            return _Installed(name, found.version, installer, record)
    return _Installed(TOOLKIT)


def _requirement(name: str, base: _Installed, extras: str = "") -> list[str]:
    """One of our distributions in the words of pip, from where `base` came from."""
    path, folder = base.path, _FOLDERS[name]
    if "vcs_info" in base.record:
        vcs = base.record["vcs_info"]
        inside = f"#subdirectory={folder}" if folder else ""
        url = quote(base.url, safe=_OF_URLS)
        return [f"{name}{extras} @ {vcs['vcs']}+{url}@{vcs['commit_id']}{inside}"]
    if path and path.is_dir():
        above = len(Path(_FOLDERS[base.name]).parts)
        place = [path, *path.parents][above] / folder
        return [*(["--editable"] if base.is_editable and name != NATIVE else []), f"{place}{extras}"]
    if path and path.is_file():
        wanted = f"{path}{extras}" if name == base.name else f"{name}=={base.version}"
        return ["--find-links", str(path.parent), wanted]
    if base.url and path is None and name == base.name:
        return [f"{name}{extras} @ {base.url}"]
    wanted = f"{name}{extras}"
    if base.version and not (PUBLISHED and name == base.name):
        wanted = f"{wanted}=={base.version}"  # another may not fit, or be a stranger's
    return [wanted] if PUBLISHED else ["--find-links", _WHEELS, wanted]


def _command(base: _Installed, arguments: Sequence[str]) -> str:
    return " ".join([*_installer(base), "install", *map(_quoted, arguments)])


def _installer(base: _Installed) -> list[str]:
    """The command that installs into this environment; a bare `pip` only if a shell finds the right one."""
    if base.installer == "uv" and shutil.which("uv"):
        return ["uv", "pip"]
    pip = shutil.which("pip")
    if pip and Path(pip).parent.samefile(Path(sys.executable).parent):
        return ["pip"]
    return [_quoted(sys.executable), "-m", "pip"]


def _quoted(word: str) -> str:
    return subprocess.list2cmdline([word]) if os.name == "nt" else shlex.quote(word)
