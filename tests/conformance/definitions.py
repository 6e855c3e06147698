"""The definitions of conformance_msgs: every primitive in every kind of field, at every position modulo 8."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Final

INTERFACES: Final = Path(__file__).with_name("interfaces")
PRIMITIVES: Final = (
    *("bool", "byte", "char", "int8", "uint8", "int16", "uint16", "int32", "uint32", "int64", "uint64"),
    *("float32", "float64", "string", "wstring", "string<=5", "wstring<=5"),
)
NESTED: Final = {
    "Nothing": "",
    "Mixed": "uint8 a\nfloat64 b\nuint8 c\n",
    "Texts": "string a\nuint16 b\n",
    "Lists": "uint8 n\nuint32[] values\nfloat64[] more\n",
    "geometry_msgs/Point": None,
}
KINDS: Final = {"scalar": "", "fixed": "[3]", "bounded": "[<=3]", "unbounded": "[]"}

CONSTANTS: Final = """\
bool YES=true
byte OCTET=255
char LETTER=65
int8 LEAST8=-128
uint8 MOST8=255
int16 LEAST16=-32768
uint16 MOST16=65535
int32 LEAST32=-2147483648
uint32 MOST32=4294967295
int64 LEAST64=-9223372036854775808
uint64 MOST64=18446744073709551615
float32 THIRD=0.333333333
float64 TENTH=0.1
float64 LARGE=1e300
float32 MINUS_ZERO=-0.0
string WORDS="a \\"b\\" 'c'"
string EMPTY=""
uint8 value
"""
DEFAULTS: Final = """\
bool yes true
byte octet 7
char letter 65
int8 least8 -128
int16 least16 -32768
int32 least32 -2147483648
int64 least64 -9223372036854775808
uint64 most64 18446744073709551615
float32 third 0.333333333
float64 tenth 0.1
string words "two words"
string<=5 brief "brief"
wstring wide "wide"
bool[2] flags [true, false]
float64[3] point [0.5, -1.0, 1e10]
int16[<=3] few [1, -2]
uint64[] many [1, 18446744073709551615]
string[] names ["a", "", "b c"]
uint8 last 255
"""
WORDS: Final = """\
uint8 type
uint8 match
uint8 func
uint8 var
uint8 let
uint8 self
uint8 super
uint8 crate
uint8 constructor
uint8 prototype
uint8 arguments
uint8 final
"""


def file_name(type_: str) -> str:
    """The name of the message for a primitive or a nested type: `Float64`, `StringMost5`, `OfMixed`."""
    if type_ in NESTED:
        return f"Of{type_.rpartition('/')[2]}"
    name = type_.replace("<=", "Most").replace("wstring", "WString")
    return name[0].upper() + name[1:].replace("int", "int")


def files() -> Iterator[tuple[str, str]]:
    """The name and the text of each definition."""
    yield from ((name, text) for name, text in NESTED.items() if text is not None)
    yield from (("Constants", CONSTANTS), ("Defaults", DEFAULTS), ("Words", WORDS))
    for type_ in (*PRIMITIVES, *NESTED):
        fields = (f"uint8[<=7] lead_{kind}\n{type_}{_suffix(type_, kind)} {kind}\n" for kind in KINDS)
        yield file_name(type_), "".join(fields) + "uint8 tail\n"
        yield f"{file_name(type_)}At", "".join(_static(type_))


def _suffix(type_: str, kind: str) -> str:
    # rosidl applies the bound of `wstring<=5[]` to the sequence, too.
    return "[<=9]" if (type_, kind) == ("wstring<=5", "unbounded") else KINDS[kind]


def _static(type_: str) -> Iterator[str]:
    """Fields that a generator can align itself: the position of each is known modulo 8."""
    for kind in ("scalar", "fixed", "unbounded"):
        for position in range(8):
            yield f"uint64 anchor_{kind}{position}\n"
            if position:
                yield f"uint8[{position}] lead_{kind}{position}\n"
            yield f"{type_}{_suffix(type_, kind)} {kind}{position}\n"
    yield "uint8 tail\n"


def write() -> None:
    """Write the package."""
    folder = INTERFACES / "conformance_msgs"
    for kind in ("msg", "srv", "action"):
        (folder / kind).mkdir(parents=True, exist_ok=True)
    for name, text in files():
        (folder / f"msg/{name}.msg").write_text(text)
    (folder / "srv/Ask.srv").write_text("Mixed[<=2] what\nstring<=5 how\n---\nOfMixed[] answer\n")
    (folder / "action/Go.action").write_text("uint8 fast\nMixed where\n---\n---\nfloat64[] path\n")
    (folder / "package.xml").write_text(
        '<package format="3"><name>conformance_msgs</name><version>1.0.0</version><description>Messages of the'
        ' conformance suite.</description><maintainer email="none@example.com">ifgen</maintainer>'
        "<license>Apache-2.0</license><depend>geometry_msgs</depend><buildtool_depend>"
        "rosidl_default_generators</buildtool_depend><member_of_group>rosidl_interface_packages"
        "</member_of_group></package>\n"
    )


if __name__ == "__main__":
    write()
