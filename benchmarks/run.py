"""Runs every benchmark and writes docs/benchmarks.md: `make bench`.

python benchmarks/run.py [NAME...]            only these, such as `codec generate`; nothing is written
python benchmarks/run.py --replace NAME...    only these; their sections in the report are replaced
"""

from __future__ import annotations

import os
import platform
import re
import subprocess
import sys
from collections.abc import Iterable
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

HERE = Path(__file__).resolve().parent
REPORT = HERE.parent / "docs" / "benchmarks.md"
PEERS = ("numpy", "ros-rclpy", "ros-rosidl-generator-py", "rosbags", "mcap-ros2-support-fast")
INTRODUCTION = """\
# Benchmarks

The figures of a section are from one run on one machine, with the peers measured side by side in it.
`make bench` measures all again, `python benchmarks/run.py --replace NAME` one section. Ratios say more than
seconds, which depend on the machine and its load.
"""


def main() -> None:
    """Run the scripts, show what they print, and keep it."""
    names = [word for word in sys.argv[1:] if word != "--replace"]
    scripts = [path for path in sorted(HERE.glob("[!_]*.py")) if path.name != "run.py"]
    chosen = [path for path in scripts if not names or path.stem in names]
    sections = {script.name: section(script) for script in chosen}
    if chosen == scripts:
        REPORT.write_text(
            "\n".join([INTRODUCTION, machine(), *filter(None, sections.values())]), encoding="utf-8"
        )
        print(f"written to {REPORT.relative_to(HERE.parent)}")
    elif "--replace" in sys.argv[1:]:
        REPORT.write_text(replaced(REPORT.read_text(encoding="utf-8"), sections.values()), encoding="utf-8")
    if failed := [name for name, text in sections.items() if text is None]:
        sys.exit(f"failed: {', '.join(failed)}")


def section(script: Path) -> str | None:
    """The heading and output of a script; None if it fails."""
    title = script.read_text(encoding="utf-8").removeprefix('"""').partition("\n")[0].rstrip(".")
    print(f"{script.name} ...", flush=True)
    # Processes that a benchmark starts keep their byte code, as for users.
    environment = {key: value for key, value in os.environ.items() if key != "PYTHONDONTWRITEBYTECODE"}
    command = [sys.executable, str(script)]
    load = f"begun at load {os.getloadavg()[0]:.1f} on {os.cpu_count()} cores"
    done = subprocess.run(command, env=environment, stdout=subprocess.PIPE, text=True, check=False)
    print(done.stdout)
    if done.returncode:
        return None
    return f"## {title}\n\n`python benchmarks/{script.name}`, {load}\n\n{done.stdout}"


def replaced(report: str, sections: Iterable[str | None]) -> str:
    """The report with sections in place of those of the same script; new ones come last."""
    head, *others = re.split(r"^(?=## )", report, flags=re.MULTILINE)
    by_script = {_script(text): text for text in [*others, *filter(None, sections)]}
    return "\n".join(text.rstrip("\n") + "\n" for text in (head, *by_script.values()))


def _script(section: str) -> str:
    return section.partition("`python benchmarks/")[2].partition("`")[0]


def machine() -> str:
    """The machine of the measurements, and the versions."""
    lines = [
        f"{os.cpu_count()} x {processor()}, {platform.system()} {platform.machine()}, "
        f"{platform.python_implementation()} {platform.python_version()}",
        ", ".join(f"{name} {found}" for name in PEERS if (found := installed(name))),
    ]
    return "\n\n".join(filter(None, lines)) + "\n"


def processor() -> str:
    """The name of the processor, if the system reports it."""
    try:
        info = Path("/proc/cpuinfo").read_text(encoding="utf-8")
    except OSError:
        return platform.processor() or "unknown processor"
    names = [line.partition(":")[2].strip() for line in info.splitlines() if line.startswith("model name")]
    return names[0] if names else platform.processor() or "unknown processor"


def installed(name: str) -> str | None:
    """The version of a distribution, if it is installed."""
    try:
        return version(name)
    except PackageNotFoundError:
        return None


if __name__ == "__main__":
    main()
