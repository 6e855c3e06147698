"""Runs several programs written for rclpy in one process: `ifgen run server.py : client.py 41 1`.

Each program has a thread, a `Program` (default context, global executor) and a `sys.argv` of its own, and
believes to be alone. The main thread waits for the last one; when it ends, the others are interrupted as by
Ctrl-C. A program that assigns a new list to `sys.argv` changes it for all. A program that is alone needs none
of this: `ifgen run` runs it as Python would.
"""

from __future__ import annotations

import contextlib
import ctypes
import importlib.util
import sys
import threading
import traceback
from collections import UserList
from collections.abc import Iterator
from pathlib import Path
from types import CodeType, ModuleType
from typing import Any

from rmw_local import timing

from rclpy.executors import ExternalShutdownException
from rclpy.impl import program
from rclpy.impl.program import Program

_INTERRUPTED = 130  # what a shell reports of a program that Ctrl-C ended
_PATIENCE = 5.0  # [s] that an interrupted program has for ending


def run(command_lines: list[list[str]]) -> int:
    """Run two programs or more, each `[FILE, ARGUMENTS...]` or `["-m", MODULE, ARGUMENTS...]`.

    Returns the exit code: the worst of all; 1 if one of them cannot be run, and then none is.
    """
    try:
        runs = [_Run(command_line) for command_line in command_lines]
    except (OSError, ModuleNotFoundError) as error:
        print(f"ifgen: {error}", file=sys.stderr)
        return 1
    except Exception as error:  # of the compiler, or of a package that holds a module
        _print_error(error)
        return 1
    with _seen_by_each_thread():
        for one in runs:
            one.start()
        try:
            _wait_for(runs[-1])
            interrupted_by_user = False
        except KeyboardInterrupt:
            interrupted_by_user = True
            runs[-1].interrupt()
        for one in runs[:-1]:
            one.interrupt()
        for one in runs:
            one.join()
    codes = [one.code(expected=not interrupted_by_user and one is not runs[-1]) for one in runs]
    return max(codes)


class _Run:
    """One program: where its code is, its thread, how it ended."""

    def __init__(self, command_line: list[str]) -> None:
        self.name, self.code_object, argv, self._folder, self._package = _locate(command_line)
        self.program = Program(argv)
        # A daemon, so that one that does not end when it is told to keeps nobody waiting.
        self._thread = threading.Thread(target=self._run_in_thread, name=self.name, daemon=True)
        # Ctrl-C inside `Thread.join` makes Python 3.11 believe that the thread has ended.
        self._ended = threading.Event()
        self._interrupted = False
        self._ending: BaseException | None = None

    def start(self) -> None:
        """Start its thread."""
        self._thread.start()

    def interrupt(self) -> None:
        """Do what Ctrl-C does to a program: end its contexts, raise KeyboardInterrupt in its main thread."""
        identifier = self._thread.ident
        if identifier is None or self._ended.is_set():
            return
        self._interrupted = True
        with _starting:
            ctypes.pythonapi.PyThreadState_SetAsyncExc(
                ctypes.c_ulong(identifier), ctypes.py_object(KeyboardInterrupt)
            )
        self.program.invalidate_contexts()
        timing.driver.rouse(identifier)

    def join(self) -> None:
        """Wait until it has ended, for a while if it was interrupted."""
        if not self._ended.wait(_PATIENCE):
            print(
                f"ifgen: {self.name} did not end within {_PATIENCE:.0f} s after Ctrl-C; leaving it",
                file=sys.stderr,
            )

    def is_running(self) -> bool:
        """Whether it has not ended yet."""
        return not self._ended.is_set()

    def wait(self, timeout: float) -> None:
        """Wait until it has ended, for at most so long."""
        self._ended.wait(timeout)

    def code(self, *, expected: bool) -> int:
        """Its exit code; leaving by Ctrl-C is no failure where it was `expected` to be interrupted."""
        ending = self._ending
        if self.is_running():
            return 1
        if (
            isinstance(ending, KeyboardInterrupt | ExternalShutdownException)
            and self._interrupted
            and expected
        ):
            return 0
        if isinstance(ending, KeyboardInterrupt):
            return _INTERRUPTED
        if isinstance(ending, SystemExit):
            return _exit_code(ending)
        return int(ending is not None)

    def _run_in_thread(self) -> None:
        _current.program = self.program
        try:
            self._execute()
        except SystemExit as ending:
            self._ending = ending
        except (KeyboardInterrupt, ExternalShutdownException) as ending:
            self._ending = ending
            if not self._interrupted:
                _print_error(ending)
        except BaseException as error:
            self._ending = error
            _print_error(error)
        finally:
            self._ended.set()

    def _execute(self) -> None:
        module = ModuleType("__main__")
        module.__file__ = self.code_object.co_filename
        module.__package__ = self._package
        module.__builtins__ = __builtins__  # type: ignore[attr-defined]  # as the interpreter sets it
        sys.modules["__main__"] = module  # of several programs the last one has it
        if self._folder not in sys.path:
            sys.path.insert(0, self._folder)
        exec(self.code_object, module.__dict__)


def _locate(command_line: list[str]) -> tuple[str, CodeType, list[str], str, str | None]:
    """A program's name, its code, its sys.argv, the folder that it imports from, and its package."""
    first, *arguments = command_line
    if first != "-m":
        path = Path(first)
        code = compile(path.read_bytes(), str(path), "exec", dont_inherit=True)
        return path.name, code, [first, *arguments], str(path.resolve().parent), None
    if str(Path.cwd()) not in sys.path:
        sys.path.insert(0, str(Path.cwd()))
    name, *arguments = arguments
    specification = importlib.util.find_spec(name)
    if specification is not None and specification.submodule_search_locations is not None:
        specification = importlib.util.find_spec(f"{name}.__main__")
    loader: Any = specification and specification.loader
    if specification is None or specification.origin is None or not hasattr(loader, "get_code"):
        raise ModuleNotFoundError(f"no module named {name!r} that can be run", name=name)
    code = loader.get_code(specification.name)
    return name, code, [specification.origin, *arguments], str(Path.cwd()), specification.parent


def _wait_for(last: _Run) -> None:
    while last.is_running():  # in steps: waiting for a thread cannot be interrupted by Ctrl-C on every system
        last.wait(0.2)


def _exit_code(ending: SystemExit) -> int:
    if ending.code is None or isinstance(ending.code, int):
        return ending.code or 0
    print(ending.code, file=sys.stderr)
    return 1


def _print_error(error: BaseException) -> None:
    # The frames above the program's own are of this module.
    trace = error.__traceback__
    while trace is not None and trace.tb_frame.f_code.co_filename == __file__:
        trace = trace.tb_next
    traceback.print_exception(type(error), error, trace)


# ---- each thread sees its own program

_current = threading.local()  # `program`, in the threads of programs

# Held while a thread starts: until it runs, Python knows it by the identifier of its starter, and would raise
# in the wrong one.
_starting = threading.Lock()


def _current_program() -> Program:
    here: Program = getattr(_current, "program", program.WHOLE_PROCESS)
    return here


class _ArgumentsOfThread(UserList[str]):
    """`sys.argv` while several programs run: each thread sees its own program's."""

    def __init__(self, of_process: list[str]) -> None:
        self._of_process = of_process

    @property
    def data(self) -> list[str]:  # type: ignore[override]  # UserList does everything on this attribute
        """The arguments of this thread's program."""
        here = getattr(_current, "program", None)
        return self._of_process if here is None else here.argv

    def __getitem__(self, index: Any) -> Any:
        return self.data[index]


@contextlib.contextmanager
def _seen_by_each_thread() -> Iterator[None]:
    """Let every thread see the arguments and context of its program, which is its starter's."""
    argv, lookup, start = sys.argv, program.current, threading.Thread.start

    def start_inheriting(thread: threading.Thread) -> None:
        here, run_thread = _current_program(), thread.run

        def run_inheriting() -> None:
            _current.program = here
            run_thread()

        thread.run = run_inheriting  # type: ignore[method-assign]
        with _starting:
            start(thread)

    sys.argv = _ArgumentsOfThread(argv)  # type: ignore[assignment]  # a list in all but name
    program.current = _current_program
    threading.Thread.start = start_inheriting  # type: ignore[assignment, method-assign]
    try:
        yield
    finally:
        threading.Thread.start = start  # type: ignore[method-assign]
        program.current = lookup
        sys.argv = argv
