"""Explanations of syntax errors in an .idl file. Called only after lark has refused it."""

from __future__ import annotations

import re
from collections.abc import Set
from typing import Final

from ifgen.diagnostics import Diagnostic, Label, Source, Span, shorten
from ifgen.idl.omg_place import CLOSING, Place, Token

_INSTEAD: Final = {
    "union": "write a struct with a member for each case, and one that says which case applies",
    "bitmask": "write an unsigned integer, and a constant for each bit",
    "bitset": "write an unsigned integer, and a constant for each bit",
    "map": "write a sequence of a message that holds a key and a value",
    "any": "a member has one type; write a message for each",
    "valuetype": "write a struct",
    "interface": "a service is a file with two structs, Name_Request and Name_Response",
    "exception": "write a message, or a member of the response, that says what went wrong",
    "native": "a type that only one language knows cannot be sent",
}
_MARKS: Final = {
    "_SEMICOLON": ";",
    "_EQUALS": "=",
    "CLOSING": ">",
    "LBRACE": "{",
    "RBRACE": "}",
    "LSQB": "[",
    "RSQB": "]",
    "LPAR": "(",
    "RPAR": ")",
    "LESSTHAN": "<",
    "COMMA": ",",
    "SHORT": "short",
    "LONG": "long",
}
_NAMES: Final = "names are letters from a to z, digits and underscores, a letter first"
_OPERATORS: Final = frozenset("+-*/%&|^~<>(")
_DEFINITIONS: Final = frozenset({"const", "typedef", "struct", "enum", "module"})
_GLUED: Final = re.compile(
    r"(const|typedef|struct|enum|module|unsigned|long|short|double|float|boolean|octet|w?char|w?string|u?int\d+)(\w+)"
)


def syntax(source: Source, position: int, expected: Set[str]) -> Diagnostic:
    """Say what is wrong at a position, where lark expected certain terminals."""
    place = Place.at(source, position, expected)
    for explain in (_no_token, _not_in_rosidl, _expression, _wrong_place, _other_spelling, _missing):
        if (diagnostic := explain(place)) is not None:
            return diagnostic
    return _unexpected(place)


def _no_token(place: Place) -> Diagnostic | None:
    """A text that cannot be divided into tokens."""
    text, start = place.source.text, place.found.start
    here = Span(place.source, start, start + 1)
    if start == 0 and text.startswith("\ufeff"):
        help = "save the file as UTF-8 without a byte order mark; rosidl refuses it"
        return _wrong(
            "the file starts with a byte order mark", Label(here, "the invisible character U+FEFF"), help
        )
    if text.startswith("/*", start):
        label = Label(Span(place.source, start, start + 2), "no `*/` follows")
        return _wrong(
            "a comment is not closed",
            label,
            "rosidl does not read `/**/`: it requires something between the stars",
        )
    if place.found.text == '"':
        line_end = text.find("\n", start)
        label = Label(
            Span(place.source, start, len(text) if line_end < 0 else line_end), 'no `"` follows on this line'
        )
        return _wrong(
            "a string is not closed", label, "a long string can consist of several, one after the other"
        )
    is_glued = place.found.start == place.last().end and place.last().text[-1:].isidentifier()
    if is_glued and place.found.text[:1].isalpha():
        # A name stops at the first letter that IDL does not know.
        span = Span(place.source, place.last().start, place.found.end)
        name = shorten(place.source.text[span.start : span.end])
        return _wrong(f"`{name}` cannot be a name", Label(span), _NAMES)
    if place.found.text == "#":
        help = "a comment starts with `//`"
        if place.expects("_MODULE"):
            help += "; of the preprocessor rosidl knows only `#include`, without a space inside"
        return _wrong("`#` does not belong here", Label(here), help)
    return None


def _not_in_rosidl(place: Place) -> Diagnostic | None:
    """Parts of OMG IDL that rosidl_parser lacks."""
    found, last = place.found, place.last()
    at_definition = place.expects("_MODULE")
    if found.text in _INSTEAD and at_definition:
        return _lacking(f"`{found.text}`", place.span(found), _INSTEAD[found.text])
    if last.text in _INSTEAD and place.last(2).text in {"", "{", "}", ";", "typedef"}:
        return _lacking(f"`{last.text}`", place.span(last), _INSTEAD[last.text])
    if at_definition and last.text == "annotation":
        help = "leave it out: an annotation need not be declared before it is used"
        return _lacking("`@annotation`", place.span(last), help)
    if found.text == ":" and place.expects("LBRACE"):
        help = "write the members of the other struct into this one, or a member of its type"
        return _lacking("inheritance", place.span(found), help)
    if found.text == "," and place.expects("_SEMICOLON") and place.statement()[0].text == "typedef":
        help = "write one typedef for each name"
        return _lacking("more than one name in a typedef", place.span(found), help)
    words = [token.text for token in place.statement()[:2]]
    if words in (["typedef", "struct"], ["typedef", "enum"]) and found.text == "{":
        help = f"a {words[1]} needs no typedef: write it by itself"
        return _lacking(f"a typedef of a {words[1]}", place.span(place.statement()[1]), help)
    return None


def _expression(place: Place) -> Diagnostic | None:
    """A value that would have to be worked out."""
    if place.found.text not in _OPERATORS or (place.expects("NAME") and not place.expects("INTEGER")):
        return None
    if not place.expects("INTEGER") and place.last().text in {"}", ")"}:
        return None
    return _lacking("an expression", place.span(place.found), "write the resulting value")


def _wrong_place(place: Place) -> Diagnostic | None:
    """Definitions in the wrong place."""
    found = place.found
    first = next(iter(place.statement()), found)
    if first.text in _DEFINITIONS and (struct := place.struct()):
        help = "a struct holds only members: put it before the struct"
        if first.text == "const":
            help = f"constants are in a module beside the struct: `module {struct}_Constants {{ ... }};`"
        what = {"const": "constant"}.get(first.text, first.text)
        return _wrong(f"a {what} cannot be inside a struct", Label(place.span(first)), help)
    if found.text == "=" and place.expects("LSQB"):
        value = place.match(r"=\s*([^;,\n]*)")
        text = shorten(value[1].strip(), 40) if value else ""
        help = f"write a default as an annotation before the type: `@default (value={text or '...'})`"
        return _wrong("a member has no `=`", Label(place.span(found)), help)
    return None


def _other_spelling(place: Place) -> Diagnostic | None:
    """Types as .msg files and other languages spell them."""
    found, last = place.found, place.last()
    if found.text == "/" and place.expects("NAME"):
        named = place.match(r"/\s*(\w+)")
        path = f"{shorten(last.text)}::msg::{shorten(named[1]) if named else 'Name'}"
        help = f"write `{path}`; only .msg files have slashes"
        return _wrong("a type has no `/`", Label(place.span(found)), help)
    if found.text == "=" and last.text == "<":
        return _wrong(
            "a bound has no `=`", Label(place.span(found)), "write `string<N>` or `sequence<TYPE, N>`"
        )
    brackets = place.match(r"\[([^\]\n]*)\]\s*([A-Za-z]\w*)?") if place.expects("NAME") else None
    if brackets is None:
        return None
    size, name, type_ = brackets[1].strip(), shorten(brackets[2] or "name"), shorten(last.text)
    help = f"the brackets follow the name: `{type_} {name}[{shorten(size, 20)}]`"
    if not size or size.startswith("<="):
        bound = f", {shorten(size[2:].strip(), 20)}" if size else ""
        help = f"write `sequence<{type_}{bound}> {name}`"
    return _wrong("a type has no brackets", Label(place.span(found)), help)


def _missing(place: Place) -> Diagnostic | None:
    """A bracket, a semicolon or a brace that was left out."""
    if (opening := place.open_bracket()) and not place.expected & {"INTEGER", "SEQUENCE"}:
        return _wrong(
            f"expected `{CLOSING[opening.text]}`, found {_shown(place.found)}",
            Label(place.span(place.found)),
            others=(Label(place.span(opening), "opened here"),),
        )
    if place.expects("_SEMICOLON"):
        label = Label(place.after_last(), "it belongs here")
        if place.last().text != "}":
            return _wrong(f"expected `;`, found {_shown(place.found)}", label)
        message = "the `;` after a `}` is missing"
        return _wrong(
            message, label, "modules, structs and enums end with `;`, too", place.brace(closed=True)
        )
    if not place.found.text and place.expects("RBRACE"):
        label = Label(place.span(place.found), "the file ends here")
        return _wrong("a `}` is missing", label, others=place.brace(closed=False))
    return None


def _unexpected(place: Place) -> Diagnostic:
    help = None
    if place.in_struct:
        expected = "a member such as `double x;`"
    elif place.expects("_MODULE"):
        expected, help = (
            "a module, a struct or another definition",
            "docs/idl.md says what an .idl file can hold",
        )
    elif place.expects("SEQUENCE"):
        expected = "a type"
    elif place.expects("INTEGER"):
        expected = "a value"
    elif place.expects("NAME"):
        expected, help = "a name", _NAMES
    else:
        marks = sorted(f"`{_MARKS[name]}`" for name in place.expected if name in _MARKS)
        expected = " or ".join(marks) or "something else"
    glued = _GLUED.fullmatch(place.found.text) or _GLUED.fullmatch(place.last().text)
    if glued:
        help = f"is a space missing, as in `{glued[1]} {glued[2]}`?"
    return _wrong(f"expected {expected}, found {_shown(place.found)}", Label(place.span(place.found)), help)


def _shown(token: Token) -> str:
    return f"`{shorten(token.text)}`" if token.text else "the end of the file"


def _lacking(what: str, span: Span, help: str) -> Diagnostic:
    return Diagnostic(
        "idl-unsupported", f"{what} is not supported", Label(span, "rosidl_parser refuses it"), help=help
    )


def _wrong(message: str, label: Label, help: str | None = None, others: tuple[Label, ...] = ()) -> Diagnostic:
    return Diagnostic("idl-syntax", message, label, others, help)
