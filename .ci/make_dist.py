"""Builds the distributions, as they go to a package index, and checks them.

Usage: python .ci/make_dist.py FOLDER [--no-isolation], where the dependency group `dist` is installed. Wheels
of the type support for real rclpy are built where Linux has a C compiler: for this machine, and for aarch64
if Debian's gcc-aarch64-linux-gnu is installed. They use the limited API, so headers of any CPython will do.
"""

from __future__ import annotations

import os
import platform
import shutil
import subprocess
import sys
import tarfile
import tempfile
from collections.abc import Mapping
from pathlib import Path

ROOT = Path(__file__).parent.parent
NATIVE = ROOT / "codegen/native"
PURE = (ROOT, ROOT / "codegen/runtime")
CROSS = "aarch64"
CROSS_COMPILER = f"{CROSS}-linux-gnu-gcc"
# Meant so: ament wants a node's description twice, ROS calls launch files x.launch.py, and the toolkit brings
# its pytest plugin.
ACCEPTED = "W002,W004,W009"


def main() -> None:
    """Build everything into a folder, in the place of what an earlier run left there."""
    output, *options = sys.argv[1:]
    folder = Path(output).absolute()
    folder.mkdir(parents=True, exist_ok=True)
    for old in folder.glob("ifgen_ros*"):
        old.unlink()
    for project in PURE:
        build(project, folder, *options)  # the sdist, and the wheel from it
    build(NATIVE, folder, "--sdist", *options)
    [sdist] = folder.glob("ifgen_ros_native-*.tar.gz")
    for architecture, environment in architectures().items():
        print(f"ifgen-ros-native for {architecture}", flush=True)
        native_wheel(sdist, folder, options, environment)
    files = sorted(folder.glob("ifgen_ros*"))
    check(files)
    print(*(path.name for path in files), sep="\n")


def architectures() -> dict[str, dict[str, str]]:
    """What wheels with C can be built for here, and what setuptools has to be told for it."""
    if platform.system() != "Linux":
        return {}
    found: dict[str, dict[str, str]] = {}
    if shutil.which("cc"):
        found[platform.machine()] = {}
    if CROSS not in found and shutil.which(CROSS_COMPILER):
        found[CROSS] = {
            "CC": CROSS_COMPILER,
            "LDSHARED": f"{CROSS_COMPILER} -shared",
            "_PYTHON_HOST_PLATFORM": f"linux-{CROSS}",
        }
    return found


def native_wheel(sdist: Path, folder: Path, options: list[str], environment: Mapping[str, str]) -> None:
    """A wheel from the sdist, tagged with the oldest glibc that it runs on."""
    with tempfile.TemporaryDirectory() as temporary:
        here = Path(temporary)
        with tarfile.open(sdist) as archive:
            archive.extractall(here, **({"filter": "data"} if hasattr(tarfile, "data_filter") else {}))
        source = here / sdist.name.removesuffix(".tar.gz")
        build(source, here / "built", "--wheel", *options, environment=environment)
        [wheel] = (here / "built").iterdir()
        run("auditwheel", "repair", "--wheel-dir", folder, wheel)


def check(files: list[Path]) -> None:
    """Let those who know look at what was built."""
    run("twine", "check", "--strict", *files)
    run("check-wheel-contents", "--ignore", ACCEPTED, *(path for path in files if path.suffix == ".whl"))
    if natives := [path for path in files if "abi3" in path.name]:
        run("abi3audit", "--strict", *natives)


def build(project: Path, folder: Path, *options: str, environment: Mapping[str, str] | None = None) -> None:
    """Call pypa's build."""
    run("python", "-m", "build", *options, "--outdir", folder, project, environment=environment)


def run(tool: str, *arguments: str | Path, environment: Mapping[str, str] | None = None) -> None:
    """Run a tool of this Python's environment; what it prints is shown only if it fails."""
    programs = Path(sys.executable).parent
    path = f"{programs}{os.pathsep}{os.environ['PATH']}"
    command = [sys.executable if tool == "python" else programs / tool, *arguments]
    done = subprocess.run(
        command,
        cwd=ROOT,
        env={**os.environ, "PATH": path, **(environment or {})},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        check=False,
    )
    if done.returncode:
        sys.exit(f"{done.stdout}\nerror: this failed: {' '.join(map(str, command))}")


if __name__ == "__main__":
    main()
