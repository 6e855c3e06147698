"""The grammar of texts with substitutions."""

from __future__ import annotations

import random

import pytest
from launch._errors import LaunchError
from launch.frontend.parse_substitution import parse

PLACE = ("a.launch.xml", 7)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("", ["''"]),
        ("a 'b' \"c\" (d)", ["'a 'b' \"c\" (d)'"]),
        (r"\$(var x) \\", [r"'$(var x) \'"]),
        ("$(var x)", ["LaunchConfig('x')"]),
        ("a$(var x)b", ["'a'", "LaunchConfig('x')", "'b'"]),
        ("$(env HOME '/a b')", ["EnvVar('HOME')"]),
        ("$(var $(var x))", ["LaunchConfig(LaunchConfig('x'))"]),
        ("$(eval '(1 + $(var x)) * 2')", ["PythonExpr('(1 + ' + LaunchConfig('x') + ') * 2')"]),
        ("$(find-pkg-share a_b)/c", ["FindPackageShare(pkg='a_b')", "'/c'"]),
        ("$(equals $(var a) 0.1)", ["EqualsSubstitution(LaunchConfig('a') '0.1')"]),
        ("$(dirname)/$(filename)", ["ThisLaunchFileDir()", "'/'", "ThisLaunchFile()"]),
    ],
)
def test_what_texts_mean(text: str, expected: list[str]) -> None:
    assert [part.describe() for part in parse(text, PLACE)] == expected


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("$5", "a '$' stands before no '(', at character 1 of '$5'"),
        ("$(var x", "the substitution '$(var' has no ')' at its end, at character 1 of '$(var x'"),
        ("$( x)", "a substitution has no name, at character 3 of '$( x)'"),
        ("$(var 'x)", "the argument has no ' at its end, at character 7 of \"$(var 'x)\""),
        ("$(var a(b))", "an argument cannot contain '(', at character 8 of '$(var a(b))'"),
        ("$(var'x')", "expected a space or ')' in the substitution '$(var', at character 6 of \"$(var'x')\""),
        ("$(vra x)", "`ifgen launch` has no substitution '$(vra)': did you mean 'var'?"),
        ("$(var)", "the substitution '$(var)' takes 1 to 2 arguments, got 0"),
        ("$(not a b)", "the substitution '$(not)' takes 1 arguments, got 2"),
        ("$(not " * 60, "more than 50 substitutions within each other"),
    ],
)
def test_mistakes(text: str, message: str) -> None:
    with pytest.raises(LaunchError) as raised:
        parse(text, PLACE)
    assert raised.value.message.startswith(f"a.launch.xml:7: {message}")


def test_any_text_has_a_meaning_or_a_mistake_with_its_place() -> None:
    chance = random.Random(16)
    pieces = [
        "$(",
        ")",
        "(",
        "$",
        "\\",
        "'",
        '"',
        " ",
        "var",
        "x",
        "env",
        "eval",
        "not",
        "\n",
        "a-b",
        "\u00e9",
        "any",
    ]
    meant = 0
    for _ in range(3000):
        text = "".join(chance.choices(pieces, k=chance.randrange(1, 14)))
        try:
            parse(text, PLACE)
            meant += 1
        except LaunchError as error:
            assert error.message.startswith("a.launch.xml:7: ")
    assert 300 < meant < 2700
