"""`ifgen run a.py : b.py`: which program ends which, with which exit code; test_programs.py tests single ones."""

from __future__ import annotations

import contextlib
import importlib.util
import os
import re
import signal
import socket
import subprocess
import sys
import textwrap
import time
from pathlib import Path

import pytest

from tests.real_rclpy import again_if_crashed

ROOT = Path(__file__).parents[2]
LIMIT = 60.0  # [s] for one run
MISSING = [name for name in ("rclpy", "ifgen_native") if importlib.util.find_spec(name) is None]

# Spins until it is interrupted, like textbook programs.
SPINNER = """
import sys, rclpy
def main():
    rclpy.init()
    node = rclpy.create_node("spinner")
    try:
        if sys.argv[1:]:
            sys.stdout.write(sys.argv[1] + "\\n")
            sys.stdout.flush()
        open("spins", "w").close()  # others may end it from here on
        rclpy.spin(node)
    except KeyboardInterrupt:
        print("spinner: interrupted")
    finally:
        node.destroy_node()
        rclpy.try_shutdown()
    print("spinner: end")
if __name__ == "__main__":
    main()
"""


def command(*words: str, transport: str = "local") -> list[str]:
    return [sys.executable, "-m", "ifgen", "run", "--transport", transport, *words]


on_both = pytest.mark.parametrize(
    "transport",
    [
        "local",
        pytest.param(
            "rclpy",
            marks=[
                pytest.mark.skipif(bool(MISSING), reason=f"not installed: {', '.join(MISSING)}"),
                pytest.mark.slow,
            ],
        ),
    ],
)


def write(folder: Path, **programs: str) -> None:
    for name, text in programs.items():
        (folder / f"{name}.py").write_text(textwrap.dedent(text))


def run(folder: Path, *words: str, transport: str = "local") -> subprocess.CompletedProcess[str]:
    def once() -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            command(*words, transport=transport),
            cwd=folder,
            env=environment(),
            capture_output=True,
            text=True,
            timeout=LIMIT,
            check=False,
        )

    return again_if_crashed(transport, once, lambda ended: ended.returncode)


def environment() -> dict[str, str]:
    return {**os.environ, "PYTHONDONTWRITEBYTECODE": "1"}


def test_each_has_its_own_arguments_and_context(tmp_path: Path) -> None:
    program = """
        import sys, threading, rclpy
        assert __name__ == "__main__" and __file__.endswith("tell.py")
        rclpy.init()
        node = rclpy.create_node("before")
        def tell(who):
            words = who, node.get_name(), sys.argv[1:], len(sys.argv), list(sys.argv)[1], "x" in sys.argv
            sys.stdout.write(" ".join(map(str, words)) + "\\n")  # at once: another program prints as well
        tell("main")
        thread = threading.Thread(target=tell, args=("thread",))
        thread.start()
        thread.join()
        from concurrent.futures import ThreadPoolExecutor
        with ThreadPoolExecutor(1) as pool:
            pool.submit(tell, "pool").result()
        rclpy.shutdown()
        assert not rclpy.ok()
        import os, time
        open(f"{sys.argv[1]}_done", "w").close()
        while not os.path.exists("a_done"):  # the last one ends the other
            time.sleep(0.01)
        time.sleep(0.1)
    """
    write(tmp_path, tell=program)
    words = ["tell.py", "a", ":", "tell.py", "x", "--ros-args", "-r", "__node:=after"]
    result = run(tmp_path, *words)
    assert result.returncode == 0, result.stderr
    expected = [f"{who} before ['a'] 2 a False" for who in ("main", "thread", "pool")]
    remapped = "after ['x', '--ros-args', '-r', '__node:=after'] 5 x True"
    expected += [f"{who} {remapped}" for who in ("main", "thread", "pool")]
    assert sorted(result.stdout.splitlines()) == sorted(expected)


def test_last_one_ends_the_others(tmp_path: Path) -> None:
    waits = """
        import os, rclpy, time
        while not os.path.exists("spins"):
            time.sleep(0.01)
        rclpy.init()
        node = rclpy.create_node("last")
        while "spinner" not in node.get_node_names():
            time.sleep(0.01)
        node.destroy_node()
        rclpy.shutdown()
        print("last: end")
    """
    write(tmp_path, spinner=SPINNER, last=waits)
    result = run(tmp_path, "spinner.py", ":", "last.py")
    assert (result.returncode, result.stderr) == (0, "")
    assert result.stdout.splitlines() == ["last: end", "spinner: interrupted", "spinner: end"]


@pytest.mark.parametrize(
    ("waiting", "printed"),
    [
        ("time.sleep(0.05)", "interrupted"),
        ("executor.spin()", "interrupted or shut down"),
        *(
            pytest.param(waiting, printed, marks=pytest.mark.slow)
            for waiting, printed in (
                ("node.get_clock().sleep_for(Duration(seconds=50))", "interrupted or shut down"),
                ("node.create_client(Trigger, 'nobody').wait_for_service()", "interrupted or shut down"),
                ("sum(range(1000))", "interrupted"),
            )
        ),
    ],
)
def test_interruption_reaches_every_way_of_waiting(tmp_path: Path, waiting: str, printed: str) -> None:
    program = f"""
        import threading, time, rclpy
        from rclpy.duration import Duration
        from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
        from std_srvs.srv import Trigger
        rclpy.init()
        node = rclpy.create_node("waiting")
        executor = MultiThreadedExecutor(2)
        executor.add_node(node)
        try:
            while rclpy.ok() or {printed == "interrupted"}:
                {waiting}
            print("shut down")
        except KeyboardInterrupt:
            print("interrupted")
        except ExternalShutdownException:
            print("shut down")
    """
    waits = """
        import rclpy, time
        rclpy.init()
        node = rclpy.create_node("last")
        while "waiting" not in node.get_node_names():
            time.sleep(0.01)
        time.sleep(0.2)  # it should be waiting by now; nothing depends on it
    """
    write(tmp_path, waiting=program, last=waits)
    result = run(tmp_path, "waiting.py", ":", "last.py")
    assert (result.returncode, result.stderr) == (0, "")
    assert result.stdout.strip() in printed.split(" or ")


@pytest.mark.parametrize(
    ("first", "last", "code", "error"),
    [
        ("pass", "pass", 0, ""),
        ("import sys; sys.exit(3)", "pass", 3, ""),
        ("import sys; sys.exit(3)", "import sys; sys.exit(2)", 3, ""),
        ("pass", "import sys; sys.exit('no luck')", 1, "no luck"),
        ("raise ValueError('first')", "pass", 1, "ValueError: first"),
        ("pass", "def broken():\n    1 / 0\nbroken()", 1, "ZeroDivisionError"),
        ("pass", "raise KeyboardInterrupt", 130, "KeyboardInterrupt"),
        ("pass", "import os; exit()", 0, ""),
    ],
)
def test_exit_code_is_the_worst(tmp_path: Path, first: str, last: str, code: int, error: str) -> None:
    done = "\nfinally:\n    open('first_done', 'w').close()\n"
    first = "try:\n" + textwrap.indent(first, "    ") + done
    last = (
        "import os, time\nwhile not os.path.exists('first_done'):\n    time.sleep(0.01)\ntime.sleep(0.1)\n"
        + last
    )
    write(tmp_path, first=first, last=last)
    result = run(tmp_path, "first.py", ":", "last.py")
    assert result.returncode == code, result.stderr
    assert error in result.stderr
    assert "runner.py" not in result.stderr, "our own frames are in the traceback"


def test_modules_and_packages(tmp_path: Path) -> None:
    package = tmp_path / "robot"
    package.mkdir()
    (package / "__init__.py").write_text("")
    (package / "names.py").write_text("NAME = 'robot'\n")
    # One `write` each: no line of another program can come in between.
    tell = "import os, sys, time\nfrom {} import NAME\nsys.stdout.write(f'{} {{NAME}} {{sys.argv[1:]}}\\n')\n"
    (package / "__main__.py").write_text(tell.format(".names", "package") + "open('done', 'w').close()\n")
    wait = "while not os.path.exists('done'):\n    time.sleep(0.01)\n"
    (package / "node.py").write_text(tell.format("robot.names", "module") + wait)
    result = run(tmp_path, "-m", "robot", "1", ":", "-m", "robot.node", "2")
    assert result.returncode == 0, result.stderr
    assert sorted(result.stdout.splitlines()) == ["module robot ['2']", "package robot ['1']"]


def test_what_cannot_be_run_is_told_before_anything_runs(tmp_path: Path) -> None:
    write(tmp_path, first="print('ran')", broken="def (")
    for words, told in (
        (["first.py", ":", "missing.py"], "missing.py"),
        (["first.py", ":", "-m", "missing_module"], "missing_module"),
        (["first.py", ":", "broken.py"], "SyntaxError"),
        (["first.py", ":"], "there is no program to run"),
    ):
        result = run(tmp_path, *words)
        assert result.returncode != 0
        assert "ran" not in result.stdout
        assert told in result.stderr
        assert "runner.py" not in result.stderr, f"a traceback for a user's mistake: {result.stderr}"


CHAPTER = {
    "server": """
        import rclpy
        from example_interfaces.srv import AddTwoInts
        def add(request, response):
            response.sum = request.a + request.b
            return response
        rclpy.init()
        node = rclpy.create_node("server")
        node.create_service(AddTwoInts, "add_two_ints", add)
        try:
            rclpy.spin(node)
        except KeyboardInterrupt:
            pass
    """,
    "client": """
        import sys
        import rclpy
        from example_interfaces.srv import AddTwoInts
        rclpy.init()
        node = rclpy.create_node("client")
        client = node.create_client(AddTwoInts, "add_two_ints")
        while not client.wait_for_service(timeout_sec=1.0):
            pass
        future = client.call_async(AddTwoInts.Request(a=int(sys.argv[1]), b=int(sys.argv[2])))
        rclpy.spin_until_future_complete(node, future)
        print("sum", future.result().sum)
    """,
}


@pytest.mark.slow
def test_a_server_and_its_client_meet_whenever_they_start(tmp_path: Path) -> None:
    write(tmp_path, **CHAPTER)
    for _ in range(20):
        result = run(tmp_path, "server.py", ":", "client.py", "41", "1")
        assert (result.returncode, result.stdout, result.stderr) == (0, "sum 42\n", "")


def test_lines_stay_whole(tmp_path: Path) -> None:
    """Python would write them in blocks, which end anywhere."""
    prints = """
        import sys
        for number in range(600):
            print(sys.argv[1], number, "a line that two programs print at the same time")
        print(sys.argv[1], "is done")
    """
    write(tmp_path, prints=prints)
    result = run(tmp_path, "prints.py", "one", ":", "prints.py", "two")
    text = "a line that two programs print at the same time"
    for who in ("one", "two"):
        mine = [line for line in result.stdout.splitlines() if line.startswith(f"{who} ")]
        assert mine[:600] == [f"{who} {number} {text}" for number in range(len(mine[:600]))]
    assert len(result.stdout.splitlines()) >= 601


@pytest.mark.parametrize("zenoh", [True, False])
def test_without_unix_sockets_they_meet_at_a_router(zenoh: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    """As on Windows. Without Zenoh, the programs themselves say that they reach nobody."""
    from ifgen.running import processes

    monkeypatch.setattr(processes, "_has_unix_sockets", lambda: False)
    for name in processes._CHOOSE_PLACE:
        monkeypatch.delenv(name, raising=False)
    if not zenoh:
        monkeypatch.setitem(sys.modules, "zenoh", None)
    with processes.meeting_place("local") as place:
        if not zenoh:
            assert place == {}
            return
        host, _, port = place["ROS_STATIC_PEERS"].removeprefix("tcp/").partition(":")
        with socket.create_connection((host, int(port)), timeout=LIMIT):
            pass
    with processes.meeting_place("rclpy") as place:
        assert place == {}


STUBBORN = """
import pathlib, sys, time
while True:
    try:
        pathlib.Path(f"begun{sys.argv[1]}").touch()
        time.sleep(0.05)
    except KeyboardInterrupt:
        pass
"""


@pytest.mark.slow  # as long as the patience
@on_both
def test_those_that_do_not_end_share_one_patience(transport: str, tmp_path: Path) -> None:
    last = """
        import pathlib, time
        while not all(pathlib.Path(f"begun{n}").exists() for n in range(3)):
            time.sleep(0.01)
    """
    write(tmp_path, stubborn=STUBBORN, last=last)
    words = [word for n in range(3) for word in ("stubborn.py", str(n), ":")]
    began = time.monotonic()
    result = run(tmp_path, *words, "last.py", transport=transport)
    assert result.returncode == 1
    assert result.stderr.count("stubborn.py did not end within 5 s after Ctrl-C") == 3
    assert time.monotonic() - began < 15, "5 s each, one after the other"


@on_both
@pytest.mark.parametrize("waiting", ["rclpy.spin(node)", "time.sleep(30)", "executor.spin()"])
def test_a_program_that_we_interrupt_counts_as_0(waiting: str, transport: str, tmp_path: Path) -> None:
    """This holds whether it is caught or not, and nothing about it is printed."""
    program = f"""
        import pathlib, time, rclpy
        from rclpy.executors import MultiThreadedExecutor
        rclpy.init()
        node = rclpy.create_node("waiting")
        executor = MultiThreadedExecutor(2)
        executor.add_node(node)
        pathlib.Path("begun").touch()
        {waiting}
    """
    last = """
        import pathlib, sys, time
        while not pathlib.Path("begun").exists():
            time.sleep(0.01)
        time.sleep(0.3)  # it should be waiting by now; nothing depends on it
        sys.exit(int(sys.argv[1]))
    """
    write(tmp_path, waiting=program, last=last)
    result = run(tmp_path, "waiting.py", ":", "last.py", "3", transport=transport)
    assert (result.returncode, result.stdout, result.stderr) == (3, "", "")


@on_both
def test_who_is_interrupted_before_it_has_begun(transport: str, tmp_path: Path) -> None:
    write(tmp_path, spinner=SPINNER, last="")
    result = run(tmp_path, "spinner.py", ":", "spinner.py", ":", "last.py", transport=transport)
    assert (result.returncode, result.stderr) == (0, "")


def test_what_failing_programs_say_is_whole(tmp_path: Path) -> None:
    """The last one to fail ends the others while they print what happened."""
    fails = """
        import os, sys
        class Failure(Exception):
            def __str__(self):
                open(sys.argv[1], "w").close()
                return sys.argv[1]
        while sys.argv[1] == "three" and not (os.path.exists("one") and os.path.exists("two")):
            pass
        raise Failure
    """
    write(tmp_path, fails=fails)
    result = run(tmp_path, *("fails.py", "one", ":", "fails.py", "two", ":", "fails.py", "three"))
    assert result.returncode == 1
    frames = f"""\
Traceback (most recent call last):
  File "{tmp_path}/fails.py", line 9, in <module>
    raise Failure
"""
    said = re.sub(r"\n +[~^]+(?=\n)", "", result.stderr)  # CPython 3.13 and newer point at the call
    for word in ("one", "two", "three"):
        assert f"{frames}Failure: {word}\n" in said
        said = said.replace(f"{frames}Failure: {word}\n", "")
    assert said == ""


def test_what_a_program_leaves_behind_goes_with_it(tmp_path: Path) -> None:
    """This includes nodes that nobody destroyed, and threads that nobody waits for."""
    leaves = """
        import threading, rclpy
        from std_msgs.msg import String
        rclpy.init()
        node = rclpy.create_node("left_behind")
        node.create_publisher(String, "left", 1)
        threading.Thread(target=rclpy.spin, args=(node,), daemon=True).start()
        def beat():
            while True:
                print(end="")
        threading.Thread(target=beat, daemon=True).start()
        other = None
        while not other:
            other = node.get_publishers_info_by_topic("right")
    """
    last = """
        import threading, time, rclpy
        from std_msgs.msg import String
        rclpy.init()
        node = rclpy.create_node("last")
        while not node.get_publishers_info_by_topic("left"):
            time.sleep(0.01)
        node.create_publisher(String, "right", 1)
        while "left_behind" in node.get_node_names() or node.get_publishers_info_by_topic("left"):
            time.sleep(0.01)
        print("gone", threading.active_count())
    """
    write(tmp_path, leaves=leaves, last=last)
    result = run(tmp_path, "leaves.py", ":", "last.py")
    assert (result.returncode, result.stdout, result.stderr) == (0, "gone 1\n", "")


@pytest.mark.skipif(sys.platform != "linux", reason="Linux tells where a signal comes from")
def test_ctrl_c_of_a_terminal_is_not_passed_on() -> None:
    """The terminal sends it to all processes; a second signal would interrupt them while they clean up."""
    program = (
        "import os, signal\nfrom ifgen.running.processes import _signals\n"
        "with _signals() as next_signal:\n"
        "    print('ready', flush=True)\n    print('terminal', next_signal(30))\n"
        "    os.kill(os.getpid(), signal.SIGTERM)\n    print('elsewhere', next_signal(30))\n"
    )
    import pty  # not every system has it

    pid, terminal = pty.fork()
    if pid == 0:
        os.execve(sys.executable, [sys.executable, "-c", program], environment())
    said = b""
    with contextlib.suppress(OSError):  # the program has closed its end
        while chunk := os.read(terminal, 1000):
            if b"ready" in chunk:
                os.write(terminal, b"\x03")
            said += chunk
    os.close(terminal)
    os.waitpid(pid, 0)
    assert b"terminal (2, True)" in said, said
    assert b"elsewhere (15, False)" in said, said


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["-h"], "Usage: ifgen run"),
        (
            ["last.py", "--ros-args", "-p", "rate=2.0"],
            "error[no-program]: `-p rate=2.0` sets no parameter\n  = help: write `-p rate:=2.0`",
        ),
        (["-m", "nope"], "error[no-program]: there is no module 'nope'"),
        (["-m", "os.nope"], "error[no-program]: there is no module 'os.nope'"),
        (["-m", "email"], "error[no-program]: the package 'email' cannot be run"),
        (["-m", "math"], "error[no-program]: the module 'math' is not Python"),
        (["-m", ""], "error[no-program]: there is no module ''"),
        (["--nope", "last.py"], "error[no-program]: there is no option '--nope'"),
        (
            ["--transprt", "local"],
            "error[no-program]: there is no option '--transprt'\n  = help: did you mean '--tran",
        ),
        (["broken.py"], '  File "{folder}/broken.py", line 1\n    def ('),
    ],
)
def test_mistakes_are_one_sentence(words: list[str], told: str, tmp_path: Path) -> None:
    write(tmp_path, broken="def (")
    result = run(tmp_path, *words)
    said = result.stdout + result.stderr
    assert said.startswith(told.format(folder=tmp_path)), said
    assert (result.returncode != 0) == (words != ["-h"])


@pytest.mark.skipif(sys.platform == "win32", reason="Windows cannot send Ctrl-C to a process")
@pytest.mark.parametrize("programs", [1, 2])
def test_ctrl_c_ends_all(tmp_path: Path, programs: int) -> None:
    write(tmp_path, spinner=SPINNER)
    other_name = ["--ros-args", "-r", "__node:=other"]
    words = ["spinner.py", "ready", *([":", "spinner.py", "ready", *other_name] if programs == 2 else [])]
    with subprocess.Popen(
        command(*words),
        cwd=tmp_path,
        env=environment(),
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    ) as process:
        assert process.stdout is not None
        try:
            ready = [process.stdout.readline() for _ in range(programs)]
            process.send_signal(signal.SIGINT)
            rest, errors = process.communicate(timeout=LIMIT)
        finally:
            process.kill()
    assert ready == ["ready\n"] * programs
    assert (process.returncode, errors) == (0, "")
    assert rest.count("spinner: interrupted") == rest.count("spinner: end") == programs
