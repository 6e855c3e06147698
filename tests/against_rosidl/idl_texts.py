"""Texts of .idl files drawn from rosidl_parser's own grammar, piece by piece, with frames that complete them."""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path
from typing import Any

from hypothesis import strategies as st
from ifgen.definition.interfaces import Folder

# The texts of the terminals. A name that begins with a keyword, or is one, is a difference that
# docs/rosidl-differences.md describes; tests/against_rosidl/idl_inputs.txt has those without a difference.
SAMPLES = {
    "IDENTIFIER": ["a", "b", "c_d", "Demo", "demo_msgs", "msg", "Foo", "key", "unit", "default", "verbatim"],
    "ESCAPED_STRING": [
        '"a"',
        '"comment"',
        '""',
        '"(1, 2)"',
        r'"a\"\\\n"',
        '"é 日"',
        r'"\x41\7\q"',
        '"// no"',
    ],
    "ESCAPED_WIDE_STRING": ['L"a"', r'L"\u00e9\\"', 'L""', r'L"\u0"'],
    "CHAR": ["a", "7", " "],
    "FLOAT": ["1.5", ".5", "1e5", "2.E-3", "1e400"],
    "DECIMAL": ["1.5", "2."],
    "INT": ["1", "007"],
    "DIGIT": list("0123456789"),
    "HEXDIGIT": ["f", "0"],
}
# Rules that are one token, or are written as one: there is no space between their parts.
CLOSE = {"decimal_literal", "octal_literal", "hexadecimal_literal", "character_literal", "include_directive"}
CLOSE |= {"wide_character_literal", "fixed_pt_literal"}
# Rules that are mostly drawn in a sensible form, so that more than a few of the files are accepted.
MEANT = {
    "positive_int_const": ["1", "3", "12"],
    "simple_type_spec": ["long long", "double", "char", "octet", "demo_msgs :: msg :: Foo", "D"],
    "annotation_appl": [
        "@key",
        '@unit(value="m")',
        "@default ( value = 1 )",
        '@verbatim (language="comment", text="a" "b")',
        "@range(min=-1, max=1.5)",
    ],
    "const_type": ["long", "double", "boolean", "string", "uint8"],
    "declarator": ["n", "n[2]"],
}
# rosidl_parser reads expressions here but evaluates few of them: mostly plain values are drawn.
CHAIN = {
    "or_expr",
    "xor_expr",
    "and_expr",
    "shift_expr",
    "add_expr",
    "mult_expr",
    "unary_expr",
    "primary_expr",
}
LIMIT = 25


class Grammar:
    """The rules of rosidl_parser's grammar.lark, and how many steps each takes at least."""

    def __init__(self) -> None:
        import rosidl_parser
        from lark import Lark

        path = Path(rosidl_parser.__file__).with_name("grammar.lark")
        parser = Lark(path.read_text(encoding="utf-8"), start="specification", maybe_placeholders=False)
        self.rules: dict[str, list[list[Any]]] = {}
        for rule in parser.rules:
            self.rules.setdefault(rule.origin.name, []).append(list(rule.expansion))
        self.patterns = {terminal.name: terminal.pattern for terminal in parser.terminals}
        self.heights: dict[str, int] = {}
        while len(self.heights) < len(self.rules):
            for name, expansions in self.rules.items():
                heights = [height for e in expansions if (height := self.height(e)) is not None]
                if heights and name not in self.heights:
                    self.heights[name] = 1 + min(heights)

    def height(self, expansion: list[Any]) -> int | None:
        """The steps that an expansion takes; None if that is not known yet."""
        names = [symbol.name for symbol in expansion if symbol.name in self.rules]
        known = [self.heights[name] for name in names if name in self.heights]
        return max(known, default=0) if len(known) == len(names) else None


@lru_cache(maxsize=1)
def grammar() -> Grammar:
    return Grammar()


@st.composite
def pieces(draw: st.DrawFn, start: str) -> str:
    """A text that a rule of the grammar allows."""
    return " ".join(_tokens(draw, start, 0))


def _tokens(draw: st.DrawFn, name: str, depth: int) -> list[str]:
    rules = grammar()
    if name in MEANT and draw(st.integers(0, 9)) < 7:
        meant = draw(st.sampled_from(MEANT[name]))
        return [meant.replace("n", f"n{draw(st.integers(0, 9999))}")] if name == "declarator" else [meant]
    if name not in rules.rules:
        return [_terminal(draw, name)]
    expansions = sorted(rules.rules[name], key=lambda e: (rules.height(e) or 0, len(e)))
    if depth > LIMIT or (name in CHAIN and draw(st.integers(0, 40)) < 40):
        expansions = expansions[:1] if name != "primary_expr" else expansions[:2]
    expansion = draw(st.sampled_from(expansions))
    tokens = [token for symbol in expansion for token in _tokens(draw, symbol.name, depth + 1)]
    return ["".join(tokens)] if name in CLOSE else tokens


def _terminal(draw: st.DrawFn, name: str) -> str:
    if name in SAMPLES:
        return draw(st.sampled_from(SAMPLES[name]))
    pattern = grammar().patterns[name]
    if type(pattern).__name__ == "PatternStr":
        return str(pattern.value)
    if pattern.to_regexp() in ("[^>]+", '[^"]+'):
        return draw(st.sampled_from(["a/msg/B.idl", "x"]))
    return draw(st.from_regex(pattern.to_regexp(), fullmatch=True))


def framed(members: str, before: str = "", constants: str = "") -> str:
    """A message with some members, after definitions and constants."""
    module = f"module Demo_Constants {{ {constants} }};" if constants else ""
    return f"module demo_msgs {{ module msg {{ {before} {module} struct Demo {{ {members} }}; }}; }};"


def _numbered(members: list[str]) -> str:
    """Members with different names: two of one name are a difference of their own."""
    return " ".join(f"double m{number}; {member}" for number, member in enumerate(members))


constants = st.lists(pieces("const_dcl").map("{};".format), max_size=2).map(" ".join)
definitions = st.lists(pieces("definition"), max_size=1).map(
    lambda drawn: " ".join(["typedef long D;", *drawn])
)
messages = st.builds(
    framed, st.lists(pieces("member"), min_size=1, max_size=2).map(_numbered), definitions, constants
)
services = st.builds(
    "module demo_msgs {{ module srv {{ struct Demo_Request {{ {} }}; {} struct Demo_Response {{ {} }}; }}; }};".format,
    pieces("member"),
    definitions,
    pieces("member"),
)
files: st.SearchStrategy[tuple[Folder, str]] = st.one_of(
    st.tuples(st.just("msg"), messages),
    st.tuples(st.just("srv"), services),
    st.tuples(st.just("msg"), pieces("specification")),
)
