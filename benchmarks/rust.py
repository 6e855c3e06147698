"""Rust: messages of the generator `rust` beside rosidl's C++ with Fast CDR.

    python benchmarks/rust.py [--rounds N]

The crates of ros2_rust come from a registry that is not within reach, so the peer is the same program in C++
(cpp_peer.cpp, `-O2`). The programs take turns; the figures are process CPU time, medians over the rounds.
"Again" reuses the vector. A view borrows strings and arrays; beside it stands the peer that decodes into an
old message. A `String` allocates, and a short `std::string` does not.
"""

from __future__ import annotations

import subprocess
import tempfile
from pathlib import Path

from cpp import HERE, compare, generate, is_ready, theirs


def ours(folder: Path) -> Path:
    """The program with the crate of ifgen, compiled for release."""
    crate = generate(folder, "rust")
    (crate / "src" / "main.rs").write_text((HERE / "rust_peer.rs").read_text(encoding="utf-8"))
    subprocess.run(["cargo", "build", "--release", "--offline", "--quiet"], cwd=crate, check=True)
    return crate / "target" / "release" / "interfaces"


if __name__ == "__main__":
    if is_ready("cargo"):
        with tempfile.TemporaryDirectory() as temporary:
            programs = ours(Path(temporary)), theirs(Path(temporary))
            compare(*programs, ("encode", "encode again", "decode", "decode a view"), "1, 1, 1, 1")
