"""Interface packages as users write them, drawn by hypothesis: every form of type, and ordinary defaults."""

from __future__ import annotations

from pathlib import Path

from hypothesis import strategies as st

INTEGERS = {
    f"{sign}int{bits}": (0, 2**bits - 1) if sign else (-(2 ** (bits - 1)), 2 ** (bits - 1) - 1)
    for sign in ("", "u")
    for bits in (8, 16, 32, 64)
}
# From datasheets, configurations and examples: hardly any of them is a float32. The last one is too large for it.
NUMBERS = [
    *("0.1", "0.8", "36.6", "-0.3", "1e-9", "3.14159265358979", "9.81", "1", "-2", ".5", "5.", "0.0", "-0.0"),
    *("1.125", "16777217.0", "1e-50", "3.4028235e38", "1e39"),
]
TEXTS = [
    *('""', '"base_link"', "'odom'", "plain", "two words", '"größe"', '"中文 🤖"', r'"a \"quoted\" word"'),
    *(r'"tab\there"', r'"a\\nb"', r'"ends with \\\\"', '"it\'s"', "'say \"hi\"'", '"100%"', '"{x}"'),
]
BOUNDED_TEXTS = ['"a"', '"größe"', "'odom'", "x y", '""', '"🤖"']
# rosidl requires ASCII in arrays.
ELEMENTS = ['"a"', "'odom'", '"x y"', '""', '"5 %"']
WORDS = [
    "speed",
    "position",
    "state",
    "name",
    "value",
    "data",
    "self",
    "from",
    "id",
    "array",
    "header_1",
    "e",
]
OTHERS = ["std_msgs/Header", "builtin_interfaces/Time", "geometry_msgs/Pose", "std_msgs/Float32"]
COMMENTS = ["# what it is", "# how far [m]", "#", "# größer als 0 [%]", "# \"quoted\" and 'quoted' \\"]


def scalars(type_: str) -> st.SearchStrategy[str]:
    """Defaults of a type, as they are written."""
    if type_ in INTEGERS:
        low, high = INTEGERS[type_]
        return st.sampled_from([str(low), str(high), "0", "7", "0x1F", "0b11", "1_0"])
    if type_ in {"float32", "float64"}:
        drawn = st.floats(allow_nan=False, allow_infinity=False).map(repr)
        return st.sampled_from(NUMBERS if type_ == "float32" else [*NUMBERS, "1e308"]) | drawn
    if type_ == "bool":
        return st.sampled_from(["true", "false", "True", "0", "1"])
    if type_ in {"byte", "char"}:
        return st.sampled_from(["0", "65", "255"])
    return st.sampled_from(TEXTS if "<=" not in type_ else BOUNDED_TEXTS)


primitives = st.sampled_from(
    [
        *(*INTEGERS, "float32", "float32", "float64", "bool", "byte", "char"),
        *("string", "wstring", "string<=5", "wstring<=5"),
    ]
)


@st.composite
def fields(draw: st.DrawFn, name: str, known: list[str]) -> str:
    """A line with a field."""
    if draw(st.integers(0, 4)) == 0:
        type_ = draw(st.sampled_from([*known, *OTHERS]))
        return f"{type_}{draw(st.sampled_from(['', '[]', '[2]', '[<=3]']))} {name}"
    type_ = draw(primitives)
    form = draw(st.sampled_from(["", "", "[]", "[2]", "[<=3]"]))
    if form and type_ == "wstring<=5":
        form = ""  # rosidl mistakes the bound of the string for that of the array
    elements = st.sampled_from(ELEMENTS) if "string" in type_ else scalars(type_)
    default = draw(
        st.lists(elements, min_size=2, max_size=2).map(lambda texts: f"[{', '.join(texts)}]")
        if form
        else scalars(type_)
    )
    written = draw(st.sampled_from([default, default, ""]))
    comment = draw(st.sampled_from(["", *COMMENTS]))
    # A `#` ends the line even within quotes.
    return f"{type_}{form} {name} {written} {comment}".rstrip()


@st.composite
def parts(draw: st.DrawFn, known: list[str]) -> str:
    """The fields and constants of a message, a request, a goal and so on."""
    names = draw(st.lists(st.sampled_from(WORDS), max_size=5, unique=True))
    lines = [draw(fields(name, known)) for name in names]
    for name in draw(
        st.lists(st.sampled_from(["A", "STATE_OK", "STATE_BAD", "MAX_2"]), max_size=3, unique=True)
    ):
        type_ = draw(primitives.filter(lambda type_: "<=" not in type_))
        lines.append(f"{type_} {name}={draw(scalars(type_))}")
    return "\n".join([*draw(st.lists(st.sampled_from(COMMENTS), max_size=1)), *lines]) + "\n"


@st.composite
def packages(draw: st.DrawFn) -> dict[str, str]:
    """The files of a package: paths and texts. A message may have fields of earlier messages."""
    found: dict[str, str] = {}
    known: list[str] = []
    for name in draw(
        st.lists(st.sampled_from(["Thing", "State", "Array", "Time", "E2E"]), min_size=1, unique=True)
    ):
        found[f"msg/{name}.msg"] = draw(parts(known))
        known.append(name)
    if draw(st.booleans()):
        found["srv/Do.srv"] = f"{draw(parts(known))}---\n{draw(parts(known))}"
    if draw(st.booleans()):
        found["action/Go.action"] = "---\n".join(draw(parts(known)) for _ in range(3))
    return found


def write(files: dict[str, str], package: Path) -> None:
    """Write the files of a package."""
    for name, text in files.items():
        (package / name).parent.mkdir(parents=True, exist_ok=True)
        (package / name).write_text(text, encoding="utf-8")
