"""Features of generated classes beyond rosidl's; tests/against_rosidl compares the common ones."""

from __future__ import annotations

import copy
import enum
import pickle
from array import array
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest

pytestmark = pytest.mark.usefixtures("importable")


@pytest.fixture
def status() -> Any:
    from class_msgs.msg import Status

    return Status


@pytest.fixture
def words() -> Any:
    from class_msgs.msg import Words

    return Words


@pytest.mark.parametrize("checks", [False, True])
def test_an_unknown_keyword_is_an_error_of_both_kinds(status: Any, checks: bool) -> None:
    from ifgen_runtime import InvalidArgumentsError

    with pytest.raises(InvalidArgumentsError) as raised:
        status(statuss=1, kind=2, also=3, check_fields=checks)
    assert isinstance(raised.value, TypeError)
    assert isinstance(raised.value, AssertionError)
    assert str(raised.value) == "Invalid arguments passed to constructor: also, statuss"
    assert raised.value.__notes__ == [
        "class_msgs/msg/Status has no field 'also' or 'statuss': did you mean 'status' for 'statuss'?"
    ]
    with pytest.raises(InvalidArgumentsError) as raised:
        status(qqq=1)
    assert raised.value.__notes__ == [
        "class_msgs/msg/Status has no field 'qqq': its fields are status, status_code, modes, kind"
    ]


def test_fields_that_are_called_as_python_needs_it(words: Any) -> None:
    message = words(from_=3, class_="c", lambda_=[1.0], self_=True, check_fields_=5)
    assert repr(message) == (
        "class_msgs.msg.Words(from_=3, class_='c', lambda_=[1.0], import_=array([1, 2], dtype=int8), "
        "is_=builtin_interfaces.msg.Time(sec=0, nanosec=0), self_=True, check_fields_=5, "
        "get_fields_and_field_types_=0)"
    )
    assert list(words.get_fields_and_field_types()) == [
        *("from", "class", "lambda", "import", "is", "self", "check_fields", "get_fields_and_field_types")
    ]
    assert words.__slots__[:2] == ["_from_", "_class_"]
    assert words.FROM__DEFAULT == words().from_ == 7


@pytest.mark.parametrize("checks", [False, True])
def test_such_fields_answer_to_their_names_in_the_definition(words: Any, checks: bool) -> None:
    values = {"from": 3, "class": "c", "import": [5, 6]}
    message = words(**values, check_fields=checks)
    assert (getattr(message, "from"), getattr(message, "class")) == (3, "c")
    assert message.import_.tolist() == [5, 6]
    setattr(message, "from", 4)
    assert message.from_ == message._from_ == 4
    assert message == words(from_=4, class_="c", import_=[5, 6]) == copy.deepcopy(message)
    assert message._check_fields is checks
    with pytest.raises(TypeError, match="constructor: nonsense"):
        words(**values, nonsense=1)


def test_checks_name_such_fields_as_attributes(words: Any) -> None:
    with pytest.raises(AssertionError, match="The 'from_' field must be of type 'int'"):
        words(**{"from": "x"}, check_fields=True)


def test_constants_of_a_field_are_an_enumeration(status: Any) -> None:
    view = status.StatusEnum
    assert issubclass(view, enum.IntEnum)
    assert {member.name: member.value for member in view} == {"UNKNOWN": 0, "RUNNING": 1, "STATUS_2ND_TRY": 2}
    assert {member.name: member.value for member in status.StatusCodeEnum} == {"OK": 0, "BAD": -1}
    assert {member.name: member.value for member in status.ModesEnum} == {"SLOW": 1, "FAST": 2}
    assert not hasattr(status, "KindEnum")
    assert (view.__module__, view.__qualname__) == ("class_msgs.msg._status", "Status.StatusEnum")
    assert status.StatusEnum is view is status().StatusEnum
    assert pickle.loads(pickle.dumps(view.RUNNING)) is view.RUNNING
    assert status(status=view.RUNNING) == status(status=status.STATUS_RUNNING)
    assert status(status=view.RUNNING, check_fields=True).status is view.RUNNING


def test_an_enumeration_is_shared_by_derived_classes(status: Any) -> None:
    class Derived(status):
        pass

    assert Derived.ModesEnum is status.ModesEnum


def test_checks_can_be_switched(status: Any) -> None:
    message = status(status=300)
    message._check_fields = True
    assert message.status == 300
    with pytest.raises(AssertionError, match=r"The 'status' field must be an integer in \[-128, 127\]"):
        message.status = 300
    with pytest.raises(AttributeError, match="property 'status' of 'Status' object has no deleter"):
        del message.status
    message._check_fields = False
    message.status = 301
    assert message.status == 301


def test_objects_with_checks_pass_for_ordinary_ones(status: Any) -> None:
    plain, checked = status(modes=[1]), status(modes=[1], check_fields=True)
    assert type(checked) is not status
    assert checked.__class__ is status
    assert isinstance(checked, status)
    assert plain == checked
    assert checked == plain
    assert repr(plain) == repr(checked)
    for twin in (copy.copy(checked), copy.deepcopy(checked), pickle.loads(pickle.dumps(checked))):
        assert twin == checked
        assert twin._check_fields


def test_derived_classes_have_checks_of_their_own(status: Any) -> None:
    class Derived(status):
        def __init__(self, *, extra: int = 0, **fields: Any) -> None:
            super().__init__(**fields)
            self.extra = extra

    message = Derived(extra=3, kind=1, check_fields=True)
    with pytest.raises(AssertionError, match="'kind'"):
        message.kind = -1
    assert message.__class__ is Derived
    twin = copy.deepcopy(message)
    assert (twin.extra, twin.kind, twin._check_fields, twin.__class__) == (3, 1, True, Derived)
    assert message == twin
    assert message != status(kind=1)


def test_derived_classes_may_have_slots(status: Any) -> None:
    class Derived(status):
        __slots__ = ("extra",)

    message = Derived(kind=1, check_fields=True)
    message.extra = 2
    twin = copy.deepcopy(message)
    assert (twin.extra, twin.kind, twin._check_fields) == (2, 1, True)
    with pytest.raises(AssertionError, match="'kind'"):
        twin.kind = -1


def test_arguments_are_copied_and_defaults_are_new() -> None:
    from class_msgs.msg import Defaults

    gains = array("f", [1.0])
    message = Defaults(gains=gains)
    assert message.gains == gains
    assert message.gains is not gains
    first, second = Defaults(), Defaults()
    for name in ("names", "gains", "mask", "stamp", "corners"):
        assert getattr(first, name) is not getattr(second, name), name
    assert first.corners[0] is not first.corners[1]
    assert Defaults.NAMES__DEFAULT is not Defaults.NAMES__DEFAULT
    assert first.NAMES__DEFAULT is second.NAMES__DEFAULT


def test_a_sentence_for_a_default_in_a_signature() -> None:
    import inspect

    from class_msgs.msg import Defaults

    signature = inspect.signature(Defaults)
    assert str(signature.parameters["x"]) == "x: 'float' = 1.5"
    assert str(signature.parameters["names"]) == "names: 'list[str]' = <default>"


class Broken(Sequence[float]):
    """A sequence of three elements that cannot be read."""

    def __len__(self) -> int:
        return 3

    def __getitem__(self, _: Any) -> Any:
        raise KeyError("broken")


@pytest.mark.parametrize("checks", [False, True])
@pytest.mark.parametrize(("value", "error"), [([10**400] * 3, OverflowError), (Broken(), KeyError)])
@pytest.mark.parametrize("field", ["lambda_", "gains", "mask"])
def test_errors_of_a_value_itself_say_which_field_it_was_for(
    words: Any, field: str, value: Any, error: type[Exception], checks: bool
) -> None:
    """The errors are those of rosidl's classes, with a note; if a check refuses a value, the text names the field.

    numpy raises TypeError for values that it cannot read.
    """
    from class_msgs.msg import Defaults

    cls = words if field == "lambda_" else Defaults
    with pytest.raises((error, AssertionError, TypeError)) as constructing:
        cls(**{field: value}, check_fields=checks)
    with pytest.raises((error, AssertionError, TypeError)) as assigning:
        setattr(cls(check_fields=checks), field, value)
    for raised in (constructing.value, assigning.value):
        if isinstance(raised, AssertionError):
            assert checks
            assert f"'{field}'" in str(raised)
        else:
            assert raised.__notes__ == [f"{cls.__name__}.{field} cannot have this value"]


def test_arrays_of_another_size_are_unequal() -> None:
    from class_msgs.msg import Defaults

    assert Defaults(mask=[1, 2]) != Defaults()  # rosidl raises ValueError
    nan = float("nan")
    assert Defaults(x=nan) != Defaults(x=nan)


def test_type_hashes_and_sources(status: Any, generated: Path) -> None:
    import ifgen
    from class_msgs.action import Walk
    from class_msgs.srv import Plan

    paths = [Path(__file__).with_name("class_msgs"), Path(__file__).resolve().parents[2] / "interfaces"]
    registry = ifgen.load(*paths)
    from ifgen.definition.type_description import type_hash

    assert status.__type_hash__ == type_hash(registry.message("class_msgs/msg/Status"), registry)
    assert Plan.__type_hash__ == type_hash(registry.interface("class_msgs/srv/Plan"), registry)
    feedback = registry.message("class_msgs/action/Walk_FeedbackMessage")
    assert Walk.Impl.FeedbackMessage.__type_hash__ == type_hash(feedback, registry)
    from class_msgs.msg import _status

    assert _status.__source__ == (paths[0] / "msg" / "Status.msg").read_text()


def test_folders_list_their_classes() -> None:
    import class_msgs.action
    import class_msgs.msg

    assert class_msgs.msg.__all__ == ["Defaults", "Status", "Words"]
    assert class_msgs.action.__all__ == [
        "Walk",
        *(f"Walk_GetResult_{part}" for part in ("Event", "Request", "Response")),
        *(f"Walk_SendGoal_{part}" for part in ("Event", "Request", "Response")),
    ]
    assert set(class_msgs.msg.__all__) < set(dir(class_msgs.msg))
    assert class_msgs.msg._status.Status is class_msgs.msg.Status
    with pytest.raises(AttributeError, match=r"module 'class_msgs.msg' has no attribute 'Nothing'"):
        class_msgs.msg.Nothing  # noqa: B018
