"""The end of a program: its exit code, and the output about an error."""

from __future__ import annotations

import importlib
import re
import sys
import traceback
from pathlib import Path
from types import TracebackType
from typing import Final

from ifgen import resources
from ifgen.reading import manifest

INTERRUPTED = 130
"""The exit code that a shell reports for a program that Ctrl-C ended."""

PATIENCE = 5.0
"""Seconds that interrupted programs have for ending, all at once."""

_WITH_A_ROS: Final = ("cv_bridge", "image_geometry", "laser_geometry", "launch_testing", "rosbag2_py")
"""Libraries of ROS that are compiled, or stand on such ones."""

_NO_SUCH_NAME: Final = re.compile(r"cannot import name '([^']+)' from '([^']+)' ")
"""The words of Python about a name that a module lacks; 3.11 has the two names nowhere else."""

_HERE = Path(__file__).parent
_IMPORTING = {importlib.__file__, "<frozen importlib._bootstrap>", "<frozen importlib._bootstrap_external>"}
"""The files of Python's own part of an import, as frames name them."""


def exit_code(ending: BaseException | None) -> int:
    """The code that a process would end with whose program ended so; None: it came to its end."""
    if ending is None:
        return 0
    if isinstance(ending, KeyboardInterrupt):
        return INTERRUPTED
    if not isinstance(ending, SystemExit):
        return 1
    if ending.code is None:
        return 0
    return ending.code & 0xFF if isinstance(ending.code, int) else 1


def is_interruption(ending: BaseException | None) -> bool:
    """Whether it is what Ctrl-C ends a program with."""
    executors = sys.modules.get("rclpy.executors")
    kinds = (KeyboardInterrupt, *([executors.ExternalShutdownException] if executors else []))
    return isinstance(ending, kinds)


def tell(ending: BaseException) -> None:
    """Print what Python would at the end of a program: an error, or the words that it left with."""
    if isinstance(ending, SystemExit):
        if ending.code is not None and not isinstance(ending.code, int):
            print(ending.code, file=sys.stderr)
        return
    if isinstance(ending, KeyboardInterrupt) and _is_importing(ending.__traceback__):
        print("interrupted", file=sys.stderr)
        return
    if isinstance(ending, ImportError) and (advice := _advice(ending)):
        ending.add_note(advice)
    each: BaseException | None = ending
    while each is not None:
        each.__traceback__ = _without_ours(each.__traceback__)
        each = each.__cause__ or each.__context__
    hook = sys.excepthook
    if hook is not sys.__excepthook__ or sys.stderr is None or sys.stderr.isatty():
        hook(type(ending), ending, ending.__traceback__)
    else:
        # In one piece: another program may print as well.
        print("".join(traceback.format_exception(ending)), end="", file=sys.stderr, flush=True)


def _advice(error: ImportError) -> str:
    """Advice about what is not there: something spelled like it, or what to do without it."""
    if isinstance(error, ModuleNotFoundError):
        parent, _, name = (error.name or "").rpartition(".")
        return _inside(parent, name) if parent in sys.modules else _advice_on_package(error)
    wrong = _NO_SUCH_NAME.match(str(error))
    if not wrong:
        return ""
    # Python looks for suggestions in the outermost package only.
    return _inside(wrong[2], wrong[1], is_suggested=hasattr(error, "name_from") and "." not in wrong[2])


def _inside(module_name: str, wrong: str, *, is_suggested: bool = False) -> str:
    """Advice about a name in a module.

    Where Python has a suggestion itself (since 3.12), it is of what the module has, not of its modules.
    """
    from difflib import get_close_matches  # only a mistake needs it
    from pkgutil import iter_modules

    module = sys.modules.get(module_name)
    names = set(dir(module))
    modules = {each.name for each in iter_modules(getattr(module, "__path__", ()))}
    known = modules - names if is_suggested else modules | names
    near = get_close_matches(wrong, sorted(each for each in known if each[:1] != "_"), n=1, cutoff=0.6)
    return f"help: did you mean '{module_name}.{near[0]}'?" if near and near[0] != wrong else ""


def _advice_on_package(error: ModuleNotFoundError) -> str:
    """Advice about a package that is not there."""
    from difflib import get_close_matches  # only a mistake needs it

    name = (error.name or "").partition(".")[0]
    if name in _WITH_A_ROS:
        return (
            f"help: '{name}' comes with a ROS only: source one. docs/libraries.md lists what ifgen has; "
            "docs/numpy.md has images as numpy arrays, docs/bags.md has bags"
        )
    folders = (Path(entry) for entry in dict.fromkeys(sys.path) if Path(entry).is_dir())
    packages = {each.parent.name for folder in folders for each in folder.glob(f"*/{manifest.NAME}")}
    libraries = {each.parent.name for each in resources.libraries().glob("*/__init__.py")}
    near = get_close_matches(name, [*packages, *libraries, "rclpy"], n=1, cutoff=0.8)
    if near:
        return f"help: did you mean '{near[0]}'?" if near[0] != name else ""
    if name.endswith(("_msgs", "_interfaces")):
        return f"help: put the interfaces of '{name}' among those of your project, and run `ifgen generate`"
    return ""


def _is_importing(trace: TracebackType | None) -> bool:
    """Whether a program still imported its modules, where nobody wants to read where."""
    own = _without_ours(trace)
    frame = None if own is None else own.tb_next
    while frame is not None:
        code = frame.tb_frame.f_code
        if code.co_name == "<module>" or code.co_filename in _IMPORTING:
            return True
        frame = frame.tb_next
    return False


def _without_ours(trace: TracebackType | None) -> TracebackType | None:
    """A traceback without the frames of this package, which run a program and are no part of it."""
    outside = trace
    while outside is not None and (_is_ours(outside) or outside.tb_frame.f_code.co_filename in _IMPORTING):
        outside = outside.tb_next
    frame = outside
    while frame is not None:
        while frame.tb_next is not None and _is_ours(frame.tb_next):
            frame.tb_next = frame.tb_next.tb_next
        frame = frame.tb_next
    return outside


def _is_ours(trace: TracebackType) -> bool:
    """Whether a frame is one of this package."""
    return Path(trace.tb_frame.f_code.co_filename).parent == _HERE
