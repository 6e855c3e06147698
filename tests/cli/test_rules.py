"""docs/rules.md is the table of all rules: it names those in the code, and each example breaks its rule."""

from __future__ import annotations

import ast
import json
import re
import shlex
from collections.abc import Iterator
from pathlib import Path

import ifgen as toolkit
import ifgen_tools as tools
import pytest
from ifgen.config import rulebook

from .conftest import Run, write

RULES = list(rulebook.rules().values())
CODE = [Path(each.__file__).parent for each in (toolkit, tools)]
MAKERS = {"Diagnostic", "Finding", "BadType", "BadValue", "_warning", "_problem", "report"}
"""What is called with the name of a rule."""
COMPUTED = {
    "duplicate-field",
    "duplicate-constant",
    "duplicate-parameter",
    "duplicate-endpoint",
    "json-syntax",
    "yaml-syntax",
    "system-frame",
    "system-major",
    "system-minor",
    "system-no-executable",
    "system-no-package",
    "system-patch",
    "system-unit",
}
"""Names that the code puts together from parts."""
IN_NEED = {"no-interfaces", "no-path", "no-program", "unknown-format", "unknown-rule"}
"""Examples on the command line that need nothing but an empty folder; the others say what they need."""
FILE_OF = {
    "msg": "demo_msgs/msg/Example.msg",
    "srv": "demo_msgs/srv/Example.srv",
    "idl": "demo_msgs/msg/Example.idl",
    "yaml": "demo/nodl/talker.nodl.yaml",
    "jinja": "templates/message_package/interface.py.j2",
    "toml": "pyproject.toml",
}


def named_in_code() -> set[str]:
    return {
        name
        for folder in CODE
        for path in folder.rglob("*.py")
        for name in _named(ast.parse(path.read_text()))
    }


def _named(tree: ast.Module) -> Iterator[str]:
    for node in ast.walk(tree):
        texts: list[ast.expr | None] = []
        match node:
            case ast.Call(
                func=ast.Name(id=name) | ast.Attribute(attr=name), args=arguments, keywords=keywords
            ):
                texts += [k.value for k in keywords if k.arg == "rule"]
                if name in MAKERS:
                    texts += arguments[2:3] if name == "report" else arguments[:1]
                elif name == "warning":  # an argument of FileProblems, which passes it on
                    texts += arguments[1:2]
            case ast.FunctionDef(
                args=ast.arguments(args=names, defaults=values, kwonlyargs=more, kw_defaults=others)
            ):
                pairs = [
                    *zip(reversed(names), reversed(values), strict=False),
                    *zip(more, others, strict=True),
                ]
                texts += [value for name, value in pairs if name.arg == "rule"]
            case _:
                pass
        for text in texts:
            if isinstance(text, ast.Constant) and re.fullmatch(r"[a-z0-9-]+", str(text.value)):
                yield str(text.value)


def test_the_page_and_the_code_name_the_same_rules() -> None:
    assert {rule.name for rule in RULES} == named_in_code() | COMPUTED


def test_a_rule_has_one_sentence_at_least_and_fits() -> None:
    for rule in RULES:
        assert rule.text.endswith("."), rule.name
        assert len(rule.name) <= 22, "the width of the column in `ifgen rules`"
        assert rule.language != "console" or f"[{rule.name}]: " in rule.example


def versions_of(rule: rulebook.Rule) -> Iterator[tuple[str, str]]:
    """The files of the earlier version and of the later one, of an example in the manner of a diff."""
    parts = re.split(r"^==> (.*) <==\n", rule.example, flags=re.MULTILINE)
    for name, text in zip(parts[1::2], parts[2::2], strict=True):
        for folder, sign in (("before", "-"), ("after", "+")):
            kept = [line[1:] for line in text.splitlines(keepends=True) if line[0] in {" ", sign}]
            if kept:
                yield f"{folder}/{name}", "".join(kept)


def files_of(rule: rulebook.Rule) -> dict[str, str]:
    if rule.of_changes:
        return dict(versions_of(rule))
    parts = re.split(r"^==> (.*) <==\n", rule.example, flags=re.MULTILINE)
    if len(parts) == 1:
        return {FILE_OF[rule.language]: rule.example}
    return dict(zip(parts[1::2], parts[2::2], strict=True))


def command_of(rule: rulebook.Rule) -> list[str]:
    match rule.language:
        case "console":
            return shlex.split(rule.example.partition("\n")[0].removeprefix("$ ifgen"))
        case "jinja":
            return ["templates", "check", "templates", "--format", "json"]
        case "toml":
            return ["generate"]
        case "diff":
            return ["breaking", "after", "--against", "before", "--format", "json"]
        case _:
            packages = {name.partition("/")[0] for name in files_of(rule)} - {"generated"}
            return ["check", *sorted(packages), "--format", "json"]


@pytest.mark.parametrize(
    "rule", [r for r in RULES if r.language != "console" or r.name in IN_NEED], ids=lambda rule: rule.name
)
def test_an_example_breaks_its_rule(ifgen: Run, rule: rulebook.Rule) -> None:
    if rule.language != "console":
        for name, text in files_of(rule).items():
            write(Path(name), text)
    if rule.language == "toml":
        write(Path("demo_msgs/msg/A.msg"), "int8 a\n")
        write(Path("demo_msgs/msg/B.msg"), "int8 a\n")
        write(Path("templates/docs.md.j2"), "")
    done = ifgen(*command_of(rule))
    if "--format" in command_of(rule):
        found = {(d["rule"], d["severity"]) for d in json.loads(done.out)["diagnostics"]}
        assert {(rule.name, rule.severity), (rule.name, "error"), (rule.name, "warning")} & found
    else:
        assert f"[{rule.name}]: " in done.err + done.out
    if rule.name in IN_NEED:
        assert (done.err + done.out).startswith(rule.example.partition("\n")[2])


def test_rules_are_listed_and_explained(ifgen: Run) -> None:
    listed = ifgen("rules").out
    assert all(len(line) <= 80 for line in listed.splitlines())
    assert listed.startswith("Warnings:\n  keyword-name            The name of a field is a keyword")
    assert ifgen("rules", "recursive-type").out == (
        "recursive-type (error)\nA message contains itself.\n\n"
        "    ==> demo_msgs/msg/Tree.msg <==\n    Tree[] branches\n"
    )
    done = ifgen("rules", "recursve-type")
    assert (done.code, done.out) == (2, "")
    assert "did you mean `recursive-type`" in done.err
