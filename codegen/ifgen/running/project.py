"""Functions for a Python program in a project that uses ifgen."""

from __future__ import annotations

from pathlib import Path
from typing import Literal

from ifgen.config.settings import settle
from ifgen.running.activation import ActivationError, Transport, put_on_path


def activate(
    transport: Literal["local", "rclpy", "auto"] = "auto", generated: str | Path | None = None
) -> Transport:
    """Let `import rclpy` and `import std_msgs.msg` find one transport's packages; returns which one.

    `local`: our rclpy and our message packages, even where a real ROS is installed. `rclpy`: the real ones;
    our packages only fill the gaps. `auto`: the real ones where they are installed, else `local`.
    `generated` is a folder with generated packages of yours, of messages and of nodes; None stands for
    `output` of the nearest pyproject.toml with `[tool.ifgen]`, or else for `generated`.
    Call it before the first import of either. Raises ActivationError if that is too late, if there is no real
    rclpy to use, or if there is no folder `generated`; InputError if `[tool.ifgen]` has mistakes.
    """
    if generated is not None and not Path(generated).is_dir():
        raise ActivationError(f"there is no folder '{generated}'; `ifgen generate -o {generated}` makes one")
    return put_on_path(transport, settle().output if generated is None else Path(generated))
