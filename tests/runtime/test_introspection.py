"""Tools that look into classes and objects: help, inspect, mock, pickle, debuggers, notebooks, pages of documentation."""

from __future__ import annotations

import abc
import contextlib
import copy
import functools
import importlib
import inspect
import io
import pdb
import pickle
import pkgutil
import pprint
import pydoc
import sys
import traceback
import typing
import weakref
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any
from unittest import mock

import pytest
import rich
from ifgen.dynamic import class_from_text
from rich.console import Console
from rich.pretty import pretty_repr

from .support import imported_from

GENERATED = Path(__file__).resolve().parents[2] / "generated"
DYNAMIC = {
    "demo/msg/Arm": "string[] names\nfloat64[3] ends\nfloat64[] angles\ndemo/Tool tool\nint32 LIMIT=3\n"
    + "=" * 80
    + "\nMSG: demo/Tool\nuint8 kind\nwstring label\n",
    "demo/srv/Grasp": "float64 force\n---\nbool done\n",
    "demo/action/Reach": "float64[3] goal\n---\nbool reached\n---\nfloat64 left\n",
}


@pytest.fixture(scope="module")
def bundled() -> Iterator[dict[str, type[Any]]]:
    """Each class of a bundled package, by its module and name."""
    packages = {
        folder.parent.name for kind in ("msg", "srv", "action") for folder in GENERATED.glob(f"*/{kind}")
    }
    with imported_from(GENERATED, packages):
        yield dict(_classes_in(packages))


def _classes_in(packages: set[str]) -> Iterator[tuple[str, type[Any]]]:
    for package in sorted(packages):
        module = importlib.import_module(package)
        for info in pkgutil.walk_packages(module.__path__, f"{package}."):
            for name, value in vars(importlib.import_module(info.name)).items():
                if (
                    isinstance(value, type)
                    and value.__module__ == info.name
                    and "__type_hash__" in vars(value)
                ):
                    yield f"{info.name}.{name}", value


@pytest.fixture(scope="module")
def looked_at(bundled: dict[str, type[Any]]) -> dict[str, type[Any]]:
    """Classes of all kinds: the base classes, bundled, of services and actions, derived, made at run time."""
    from ifgen_runtime import Action, Message, Service

    kinds = {
        "std_srvs.srv._set_bool": ["SetBool", "SetBool_Response", "SetBool_Event"],
        "sensor_msgs.msg": [
            "_joint_state.JointState",
            "_camera_info.CameraInfo",
            "_nav_sat_status.NavSatStatus",
        ],
        "example_interfaces.action._fibonacci": ["Fibonacci", "Fibonacci_Goal", "Fibonacci_SendGoal"],
    }
    chosen = {
        f"{module}.{name}": bundled[f"{module}.{name}"] for module, names in kinds.items() for name in names
    }
    chosen |= {name: class_from_text(name, text) for name, text in DYNAMIC.items()}
    impl = chosen["example_interfaces.action._fibonacci.Fibonacci"].Impl
    pose = bundled["geometry_msgs.msg._pose.Pose"]
    derived = type(pose)("Derived", (pose,), {"__module__": __name__, "label": "of a user"})
    sys.modules[__name__].Derived = derived  # where pickle looks for it
    return {
        **chosen,
        "Message": Message,
        "Service": Service,
        "Action": Action,
        "Impl": impl,
        "Derived": derived,
    }


def _pages(thing: object) -> None:
    pydoc.render_doc(thing, renderer=pydoc.plaintext)
    pydoc.html.document(thing, "thing")


def _members(thing: object) -> None:
    members = dict(inspect.getmembers(thing))
    for name in dir(thing):
        assert name in members or not hasattr(thing, name), name
    assert dict(inspect.getmembers_static(thing)).keys() <= set(dir(thing))


def _shown_by_rich(thing: object) -> None:
    rich.inspect(thing, all=True, console=Console(file=io.StringIO()))
    pretty_repr(thing)
    pprint.pformat(thing)


def _pickled(thing: Any) -> None:
    for protocol in range(pickle.HIGHEST_PROTOCOL + 1):
        assert pickle.loads(pickle.dumps(thing, protocol)) == thing
    assert pickle._loads(pickle._dumps(thing)) == thing  # type: ignore[attr-defined]  # what debuggers step through


def _source(cls: type[Any]) -> None:
    if cls.__module__ in sys.modules and cls.__name__ != "Derived":  # not made at run time
        assert f"class {cls.__name__}" in inspect.getsource(cls)
        assert inspect.getfile(cls).endswith(".py")


def _autospec(thing: Any) -> None:
    mock.create_autospec(thing)
    if isinstance(thing, type):
        mock.create_autospec(thing, instance=True)


def _hints(cls: Any) -> None:
    typing.get_type_hints(cls, include_extras=True)
    inspect.get_annotations(cls, eval_str=True)
    typing.get_type_hints(cls.__init__)


def _dispatched(cls: type[Any]) -> None:
    @functools.singledispatch
    def kind(value: object) -> str:
        return "other"

    kind.register(cls, lambda value: "found")
    assert kind.dispatch(cls)(None) == "found"


def _registered(cls: type[Any]) -> None:
    class Stamped(abc.ABC):  # noqa: B024
        pass

    Stamped.register(cls)
    assert issubclass(cls, Stamped)


def _weakly_referenced(cls: type[Any]) -> None:
    assert weakref.ref(cls)() is cls


def _asked_by_ipython(thing: object) -> None:
    inspector = pytest.importorskip("IPython.core.oinspect").Inspector(theme_name="nocolor")
    assert inspector.info(thing, oname="thing")["found"]
    inspector._get_info(thing, oname="thing", detail_level=1)
    importlib.import_module("IPython.lib.pretty").pretty(thing)


OF_CLASSES = [
    *(
        _pages,
        inspect.classify_class_attrs,
        _members,
        _source,
        inspect.signature,
        inspect.getdoc,
        _autospec,
        _hints,
    ),
    *(
        _dispatched,
        _registered,
        _weakly_referenced,
        _pickled,
        _shown_by_rich,
        _asked_by_ipython,
        sys.getsizeof,
    ),
]


@pytest.mark.parametrize("tool", OF_CLASSES, ids=lambda tool: tool.__name__.lstrip("_"))
def test_a_tool_takes_any_class(looked_at: dict[str, type[Any]], tool: Callable[[Any], object]) -> None:
    for name, cls in looked_at.items():
        try:
            tool(cls)
        except Exception as error:
            error.add_note(name)
            raise


def _copied(message: Any) -> None:
    assert copy.copy(message) == copy.deepcopy(message) == message
    if sys.version_info < (3, 13):
        return
    with pytest.raises(TypeError, match="replace"):  # rosidl's classes have none, either
        copy.replace(message)


def _as_rosidl(message: Any) -> None:
    """What rosidl's classes, which have slots and no hash, refuse as well."""
    for refused in (vars, weakref.ref, hash):
        if type(message).__dictoffset__ == 0:
            with pytest.raises(TypeError):
                refused(message)


def _in_a_traceback(message: Any) -> None:
    try:
        raise ValueError(message)
    except ValueError as error:
        shown = "".join(traceback.TracebackException.from_exception(error, capture_locals=True).format())
    assert "message = " in shown


def _in_a_debugger(message: Any) -> None:
    commands = [
        "p message",
        "pp message",
        "whatis message",
        "p dir(message)",
        "display message",
        "args",
        "continue",
    ]
    answers = io.StringIO()
    debugger = pdb.Pdb(
        stdin=io.StringIO("\n".join(commands) + "\n"), stdout=answers, nosigint=True, readrc=False
    )
    debugger.use_rawinput = False
    debugger.runcall(lambda message: message, message)
    assert answers.getvalue().count("(Pdb)") == len(commands)
    assert "***" not in answers.getvalue()


OF_OBJECTS = [
    *(
        _pages,
        _members,
        _copied,
        _pickled,
        _shown_by_rich,
        _autospec,
        _as_rosidl,
        _in_a_traceback,
        _in_a_debugger,
    ),
    *(_asked_by_ipython, sys.getsizeof, repr, str),
]


@pytest.mark.parametrize("tool", OF_OBJECTS, ids=lambda tool: tool.__name__.lstrip("_"))
@pytest.mark.parametrize("checks", [False, True])
def test_a_tool_takes_any_message(
    looked_at: dict[str, type[Any]], checks: bool, tool: Callable[[Any], object]
) -> None:
    for name, cls in looked_at.items():
        if hasattr(cls, "_fields_and_field_types"):
            try:
                tool(cls(check_fields=checks))
            except Exception as error:
                error.add_note(name)
                raise


def test_help_names_the_fields_of_every_bundled_class(bundled: dict[str, type[Any]]) -> None:
    """The classes differ in their fields only, so the tools that look at these stand for all."""
    for name, cls in bundled.items():
        hints = typing.get_type_hints(cls.__init__)
        assert typing.get_type_hints(cls).keys() <= hints.keys(), name
        inspect.classify_class_attrs(cls)
        if hasattr(cls, "_fields_and_field_types"):
            attributes = [slot.removeprefix("_") for slot in cls.__slots__[:-1]]
            assert attributes == list(inspect.signature(cls).parameters)[: len(attributes)], name
            assert set(attributes) <= hints.keys() & set(dir(cls)), name


def test_enums_and_bases_of_messages(bundled: dict[str, type[Any]]) -> None:
    status: Any = bundled["action_msgs.msg._goal_status.GoalStatus"]
    for protocol in range(pickle.HIGHEST_PROTOCOL + 1):
        assert pickle.loads(pickle.dumps(status.StatusEnum.ACCEPTED, protocol)) is status.StatusEnum.ACCEPTED
    message_class: Any = status.__base__
    for name in ("SLOT_TYPES", "Views"):
        with pytest.raises(AttributeError, match="base of message classes"):
            getattr(message_class, name)


def test_ipython_completes_and_explains(bundled: dict[str, type[Any]]) -> None:
    shell_class = pytest.importorskip("IPython.core.interactiveshell").InteractiveShell
    completer = importlib.import_module("IPython.core.completer")
    shell = shell_class(user_ns={"pose": bundled["geometry_msgs.msg._pose.Pose"]()})
    for typed, wanted in {"pose.": {"position", "orientation"}, "pose.position.": {"x", "y", "z"}}.items():
        with completer.provisionalcompleter():
            offered = list(shell.Completer.completions(typed, len(typed)))
        assert wanted <= {found.text.rpartition(".")[2] for found in offered}
    with mock.patch("sys.stdout", io.StringIO()) as shown:
        shell.run_cell("pose.__class__?\npose", store_history=False)
    assert "orientation" in shown.getvalue()


def test_pdoc_writes_a_page(bundled: dict[str, type[Any]], tmp_path: Path) -> None:
    pdoc = pytest.importorskip("pdoc")
    with pytest.warns() if sys.version_info < (3, 12) else contextlib.nullcontext() as told:
        # array.array takes no subscript before Python 3.12, in which pdoc shows the annotation as it is.
        pdoc.pdoc("std_srvs", "sensor_msgs.msg._joint_state", output_directory=tmp_path)
    assert all("'array.array' is not subscriptable" in str(warning.message) for warning in told or ())
    assert "Switches something on or off" in (tmp_path / "std_srvs/srv.html").read_text()


@pytest.mark.slow
def test_sphinx_writes_a_page_without_warnings(bundled: dict[str, type[Any]], tmp_path: Path) -> None:
    application = pytest.importorskip("sphinx.application")
    modules = ("std_msgs.msg", "sensor_msgs.msg._camera_info", "std_srvs.srv._set_bool")
    options = "   :members:\n   :undoc-members:\n   :inherited-members:\n   :private-members:\n   :special-members:\n"
    (tmp_path / "conf.py").write_text("extensions = ['sphinx.ext.autodoc', 'sphinx.ext.autosummary']\n")
    (tmp_path / "index.rst").write_text(
        "Messages\n========\n\n" + "\n".join(f".. automodule:: {module}\n{options}" for module in modules)
    )
    warnings = io.StringIO()
    folders = (tmp_path, tmp_path, tmp_path / "out", tmp_path / "trees")
    sphinx = application.Sphinx(*map(str, folders), "text", status=None, warning=warnings)
    sphinx.build()
    assert warnings.getvalue() == ""
    assert "Switches something on or off" in (tmp_path / "out/index.txt").read_text()
