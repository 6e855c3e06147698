"""TypeScript: messages of the generator `typescript` beside @foxglove/rosmsg2-serialization.

    python benchmarks/typescript.py

Both run in one process of Node and take turns. The figures are process CPU time in microseconds per call,
medians over 9 rounds. The messages are those of codec.py and a LaserScan, with text in ASCII only, since the
peer damages other text. Needs node, npm and its registry.
"""

from __future__ import annotations

import importlib
import json
import shutil
import subprocess
import sys
import tempfile
from array import array
from pathlib import Path
from typing import Any

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent
PACKAGES = ("@foxglove/rosmsg@5.0.5", "@foxglove/rosmsg2-serialization@3.1.0", "typescript@7.0.2")
CONFIG = """\
[tool.ifgen]
paths = [{paths}]
python = false
[tool.ifgen.generate.ts]
use = "typescript"
out = "ts"
"""
TSC = ("--target", "es2022", "--module", "nodenext", "--lib", "es2024,dom", "--types", "", "--outDir", "js")


def payloads() -> dict[str, bytes]:
    """A payload of each of 12 types."""
    sys.path[:0] = [str(HERE), str(ROOT / "generated")]
    codec = importlib.import_module("codec")
    from ifgen_runtime import serialize

    def cls(name: str) -> Any:
        package, folder, short = name.split("/")
        return getattr(importlib.import_module(f"{package}.{folder}"), short)

    found = dict(codec.messages(cls))
    numbers = array("f", range(720))
    scan = cls("sensor_msgs/msg/LaserScan")(ranges=numbers, intensities=numbers)
    found["sensor_msgs/msg/LaserScan"] = scan
    return {name: serialize(message) for name, message in found.items()}


def main() -> None:
    """Generate, compile, measure and print."""
    if shutil.which("npm") is None:
        print("npm is not installed")
        return
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "payloads").mkdir()
        for type_name, payload in payloads().items():
            (folder / "payloads" / f"{type_name.replace('/', '.')}.bin").write_bytes(payload)
        packages = {path.name.split(".")[0] for path in (folder / "payloads").iterdir()}
        paths = ", ".join(f'"{ROOT / "interfaces" / package}"' for package in sorted(packages))
        (folder / "pyproject.toml").write_text(CONFIG.format(paths=paths))
        (folder / "package.json").write_text(json.dumps({"type": "module"}))
        for command in (
            [sys.executable, "-m", "ifgen", "generate", "--quiet"],
            ["npm", "install", "--silent", "--no-audit", "--no-fund", *PACKAGES],
            ["npx", "tsc", *TSC, "ts/index.ts", "ts/types.ts"],
        ):
            subprocess.run(command, cwd=folder, check=True)
        command = ["node", str(HERE / "typescript_peer.mjs"), str(folder)]
        done = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=True)
    print(done.stdout, end="")


if __name__ == "__main__":
    main()
