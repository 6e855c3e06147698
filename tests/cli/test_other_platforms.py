"""ifgen and the local transport need nothing that only POSIX systems have."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

# Modules, and names in modules, that CPython has only on POSIX systems, and that we or a library might use.
MODULES = ("fcntl", "grp", "pty", "pwd", "resource", "syslog", "termios", "tty")
NAMES = {
    "os": (
        *(
            "chown",
            "eventfd",
            "fork",
            "forkpty",
            "getpgid",
            "getuid",
            "geteuid",
            "getgid",
            "killpg",
            "mkfifo",
        ),
        *("openpty", "register_at_fork", "sched_getaffinity", "setsid", "sysconf", "uname", "wait4"),
        *("O_CLOEXEC", "O_DIRECTORY", "O_NOFOLLOW", "O_NONBLOCK", "O_NOCTTY"),
    ),
    "select": ("epoll", "poll"),
    "signal": ("SIGALRM", "SIGHUP", "SIGKILL", "SIGPIPE", "SIGQUIT", "SIGUSR1", "pthread_kill", "setitimer"),
    "time": ("tzset",),
}
WITHOUT = f"""
import os, select, signal, sys, time
os.supports_dir_fd.clear()  # as on Windows: shutil goes by paths then, not by what is taken away below
# These ask which system it is, and take what that one has.
import asyncio, platform, platformdirs, random, shutil, subprocess, tempfile
platform.system()
for name in {MODULES}:
    sys.modules[name] = None
for module, names in {NAMES}.items():
    for name in names:
        vars(sys.modules[module]).pop(name, None)
from ifgen.cli.main import main
sys.argv[0] = "ifgen"
sys.exit(main())
"""
NODE = """
import rclpy
from demo_msgs.msg import Pair

rclpy.init()
node = rclpy.create_node("alone")
heard = []
node.create_subscription(Pair, "pair", heard.append, 10)
publisher = node.create_publisher(Pair, "pair", 10)
node.create_timer(0.01, lambda: publisher.publish(Pair(a=0.1, name="half")))
node.get_logger().info("running")
while not heard:
    rclpy.spin_once(node)
print(heard[0].a, heard[0].name)
node.destroy_node()
rclpy.shutdown()
"""


def ifgen(folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-c", WITHOUT, *arguments],
        cwd=folder,
        capture_output=True,
        text=True,
        encoding="utf-8",
        timeout=60,
        check=False,
    )


@pytest.fixture
def workspace(tmp_path: Path) -> Path:
    message = tmp_path / "interfaces" / "demo_msgs" / "msg" / "Pair.msg"
    message.parent.mkdir(parents=True)
    message.write_text("float64 a\nstring name\n")
    (tmp_path / "node.py").write_text(NODE, encoding="utf-8")
    (tmp_path / "pyproject.toml").write_text('[tool.ifgen]\npaths = ["interfaces"]\n')
    return tmp_path


def test_generating_and_running_without_posix(workspace: Path) -> None:
    for command in (
        ["generate"],
        ["generate", "--check"],
        ["check"],
        ["hash"],
        ["show", "demo_msgs/msg/Pair"],
    ):
        done = ifgen(workspace, *command)
        assert done.returncode == 0, done.stderr
    ran = ifgen(workspace, "run", "--transport", "local", "node.py")
    assert ran.stdout == "0.1 half\n", ran.stderr
    assert ran.returncode == 0
