"""Generated Rust: its text, the conformance suite, and the program of its page."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest

from ..conformance.support import tool
from .support import ALL, ROOT, example_of, generate, run


def test_the_text(tmp_path: Path) -> None:
    generate(tmp_path, "rust", "rs", ROOT / "interfaces/std_srvs", ROOT / "interfaces/visualization_msgs")
    text = (tmp_path / "rs/src/visualization_msgs.rs").read_text()
    assert "        pub type_: i32," in text
    assert "        pub ns: ::std::borrow::Cow<'a, str>," in text
    assert "impl cdr::Service for SetBool {" in (tmp_path / "rs/src/std_srvs.rs").read_text()
    assert "forbid(unsafe_code)" in (tmp_path / "rs/src/lib.rs").read_text()


@pytest.mark.slow
def test_clippy_has_no_complaint(tmp_path: Path) -> None:
    crate = generate(tmp_path, "rust", "rs", *ALL)
    cargo = tool("cargo")
    if subprocess.run(
        [cargo, "clippy", "--version"], capture_output=True, timeout=60, check=False
    ).returncode:
        pytest.skip("clippy is not installed")
    run([cargo, "clippy", "--offline", "--quiet", "--", "-D", "warnings"], crate)


@pytest.mark.slow
def test_the_program_of_the_page_runs(tmp_path: Path) -> None:
    cargo = tool("cargo")
    blocks = example_of("rust.md", tmp_path)
    crate = generate(tmp_path, "rust", "rs", tmp_path / "demo_msgs")
    (crate / "src/main.rs").write_text(blocks["rust"])
    assert run([cargo, "run", "--offline", "--quiet"], crate) == blocks["output"]


@pytest.mark.slow
def test_modules_of_a_crate_of_your_own(tmp_path: Path) -> None:
    cargo = tool("cargo")
    (tmp_path / "src").mkdir()
    (tmp_path / "src/main.rs").write_text(
        "#![forbid(unsafe_code)]\nmod ros;\nuse ros::cdr::Message;\n"
        'fn main() { println!("{}", ros::std_msgs::msg::String::TYPE_NAME); }\n'
    )
    (tmp_path / "Cargo.toml").write_text('[package]\nname = "robot"\nversion = "0.1.0"\nedition = "2021"\n')
    generate(tmp_path, "rust", "src/ros", ROOT / "interfaces/std_msgs", crate="", root="crate::ros")
    assert run([cargo, "run", "--offline", "--quiet"], tmp_path) == "std_msgs/msg/String\n"
