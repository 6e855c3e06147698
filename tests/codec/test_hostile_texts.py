"""Any YAML, JSON and dictionary leads soon to a message or a ConversionError, and nothing else."""

from __future__ import annotations

import time
from collections import UserDict
from typing import Any, NoReturn

import pytest
import yaml
from hypothesis import example, given, settings
from hypothesis import strategies as st
from ifgen_runtime import ConversionError, from_dict, from_json, from_yaml, serialize, to_yaml
from ifgen_runtime.convert import yaml_text

from .support import Classes

VALUES = "test_msgs/msg/BasicTypes"


def refusal(read: Any, cls: type[Any], text: object) -> str:
    """The text of the ConversionError."""
    with pytest.raises(ConversionError) as caught:
        read(cls, text)
    return str(caught.value)


NO_YAML = {
    '"\\UFFFFFFFF": 1': "the number is too large at line 1, column 4",
    '"\\U00110000": 1': "the number is too large at line 1, column 4",
    f"%YAML 1.{'1' * 5000}\n--- a": "the number is too large at line 1",
    'a: 1\nint64_value: !!int ""': "this is not a valid int at line 2, column 14",
    'float64_value: !!float ""': "this is not a valid float at line 1, column 16",
    'int64_value: !!int "_"': "this is not a valid int",
    'bool_value: !!bool "maybe"': "this is not a valid bool",
    'int64_value: !!timestamp "x"': "this is not a valid timestamp",
    "int64_value: 2020-99-99": "this is not a valid timestamp",
    "int64_value: 0x_": "this is not a valid int",
    f"int64_value: {'1' * 5000}": "this is not a valid int",
    f"float64_value: {'9:' * 40_000}1.5": "the number is too long",
    f"int64_value: {'1:' * 80_000}1": "the number is too long",
    "a: &a [*a]": "an alias is inside its own value at line 1, column 11",
    "a: *b": "found undefined alias 'b' at line 1, column 4",
    "? [a]\n: 1": "found unhashable key",
    "!!python/object:os.system {}": "could not determine a constructor for the tag",
    "a\n---\nb": "found another document at line 2, column 1",
    "a: \ud800": "special characters are not allowed",
    b"a: \xff": "unacceptable character #x00ff",
    5: "expected str or bytes, got int",
    None: "expected str or bytes, got NoneType",
}


@pytest.mark.parametrize("text", NO_YAML, ids=range(len(NO_YAML)))
def test_what_is_no_yaml(classes: Classes, text: object) -> None:
    said = refusal(from_yaml, classes[VALUES], text)
    assert said.startswith("BasicTypes: not YAML: ") and NO_YAML[text] in said
    assert len(said) < 200 and "\n" not in said


MERGED = "m0: &m0 {a: 1}\n" + "".join(f"m{i}: &m{i} {{<<: [{f'*m{i - 1}, ' * 9}]}}\n" for i in range(1, 9))
LAUGHS = "m0: &m0 [a]\n" + "".join(f"m{i}: &m{i} [{f'*m{i - 1}, ' * 9}]\n" for i in range(1, 12))
BOMBS = {
    "merge keys": (MERGED, "more than 500000 values"),
    "billion laughs": (LAUGHS, "more than 500000 values"),
    "a chain of merge keys": (
        "m0: &m0 {a: 1}\nb:\n"
        + "".join(f"- &m{i} {{<<: *m{i - 1}}}\n" for i in range(1, 900))
        + "c: {<<: *m899}",
        "",
    ),
    "long": ("x: " + "a" * 2_000_000, "longer than 2000000 characters"),
    "deep lists": ("[" * 100_000, "more than 100 deep"),
    "deep maps": ("{a: " * 100_000, "more than 100 deep"),
    "dashes": ("- " * 100_000, "more than 100 deep"),
    "questions": ("? " * 100_000, "more than 100 deep"),
}


@pytest.mark.parametrize("name", BOMBS)
def test_bombs_are_refused(classes: Classes, name: str) -> None:
    text, said = BOMBS[name]
    started = time.process_time()
    assert said in refusal(from_yaml, classes[VALUES], text)
    assert time.process_time() - started < 4


NO_MESSAGE: list[tuple[Any, str]] = [
    ({10**5000: 1}, "BasicTypes.int: no such field"),
    ({"a" * 10_000: 1}, f"BasicTypes.'{'a' * 39}...: no such field"),
    ({"a\n": 1}, "BasicTypes.'a\\n': no such field"),
    ({"byte_value": 10**5000}, "BasicTypes.byte_value: expected an integer in [0, 255], got int"),
    ({"int64_value": 10**5000}, "BasicTypes.int64_value: expected an integer in ["),
    ({"float64_value": 10**5000}, "BasicTypes.float64_value: int does not fit into a float64"),
]


@pytest.mark.parametrize(("mapping", "said"), NO_MESSAGE, ids=range(len(NO_MESSAGE)))
def test_numbers_and_names_beyond_measure(classes: Classes, mapping: Any, said: str) -> None:
    assert refusal(from_dict, classes[VALUES], mapping).startswith(said)


class Broken(list[Any]):
    """A list that cannot be read."""

    def __iter__(self) -> NoReturn:
        raise KeyError("mine")


def test_values_that_raise(classes: Classes) -> None:
    """An exception from a value's own methods becomes the cause of an error that names the field."""
    with pytest.raises(ConversionError) as caught:
        from_dict(classes["sensor_msgs/msg/JointState"], {"position": Broken([1])})
    assert str(caught.value) == "JointState.position: cannot be read: KeyError: 'mine'"
    assert isinstance(caught.value.__cause__, KeyError)

    class Unreadable(UserDict[str, Any]):
        def items(self) -> NoReturn:
            raise OSError("gone")

    said = refusal(from_dict, classes["geometry_msgs/msg/PoseStamped"], {"pose": Unreadable()})
    assert said == "PoseStamped.pose: cannot be read: OSError: gone"
    message = classes["sensor_msgs/msg/JointState"](name=Broken(["a"]))
    with pytest.raises(ConversionError, match=r"^JointState.name: cannot be read: KeyError: 'mine'$"):
        to_yaml(message)


PIECES = st.sampled_from(
    [
        *(
            "a: ",
            "- ",
            "\n",
            "\n  ",
            "[",
            "]",
            "{",
            "}",
            ", ",
            "? ",
            ": ",
            "&a ",
            "*a",
            "<<: ",
            "---",
            "...",
            "|",
            ">",
        ),
        *(
            "!!int ",
            "!!float ",
            "!!bool ",
            "!!null ",
            "!!str ",
            "!!binary ",
            "!!timestamp ",
            "!!set ",
            "!!omap ",
        ),
        *(
            "!!pairs ",
            "!!map ",
            "!!seq ",
            "! ",
            "!x ",
            "%YAML 1.1",
            "%TAG ! !",
            "#",
            "'",
            '"',
            "\\",
            "\\U00110000",
            "\\ud800",
        ),
        *(
            "1",
            "0x",
            "0b",
            "1_0",
            "1:30",
            "1:2.5",
            ".inf",
            ".nan",
            "1e5",
            "yes",
            "~",
            "=",
            "2020-01-01",
            "12:00:00Z",
            "é",
        ),
        *("data", "layout", "dim", "label", "size", "stride", "data_offset", "\ufeff", "\x85", "\t"),
    ]
)


@settings(max_examples=600)
@given(st.lists(PIECES, max_size=25).map("".join))
@example("a: !!float '1:'")
def test_any_pieces_of_yaml(classes: Classes, text: str) -> None:
    """Texts that PyYAML reads are read the same; others are refused, whatever PyYAML raises."""
    try:
        expected = repr(yaml.safe_load(text))
    except Exception:
        expected = "refused"
    try:
        found = repr(yaml_text.read(text))
    except yaml_text.YamlError as error:
        assert expected == "refused" or "an alias stands inside" in str(error), expected
    else:
        assert found == expected
    for name in ("std_msgs/msg/Float32MultiArray", "std_msgs/msg/String"):
        for read in (from_yaml, from_json):
            try:
                serialize(read(classes[name], text))
            except ConversionError as error:
                assert error.path.startswith(classes[name].__name__)
