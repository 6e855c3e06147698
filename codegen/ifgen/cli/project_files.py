"""The text that `ifgen init` adds to the files of a project. Existing lines do not change."""

from __future__ import annotations

import itertools
import json
import re
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path, PurePosixPath
from typing import Any, Final, cast

import yaml

from ifgen.diagnostics import Diagnostic, Label, Source, Span, UsageError, shown_path

REPOSITORY: Final = "https://github.com/ifgen-ros/ifgen"

_ATTRIBUTES: Final = {
    "{}/**": "text=auto eol=lf linguist-generated",
    "{}/*/*/[!_]*.py": "-linguist-generated",
}
"""Attributes for git of files in the output folder: their line ends, and which of them need no review."""

HOOKS: Final = ("ifgen-check", "ifgen-generate")
"""The hooks that .pre-commit-hooks.yaml offers."""


def with_table(path: Path, text: str, values: Mapping[str, object]) -> str:
    """A valid pyproject.toml with `[tool.ifgen]`, which it lacks. Raises UsageError if it cannot have one."""
    lines = ["[tool.ifgen]", *(f"{key} = {_toml(value)}" for key, value in values.items())]
    changed = _appended(text, lines, gap=True)
    before = tomllib.loads(text)
    tool: object = before.setdefault("tool", {})
    if isinstance(tool, dict):
        cast("dict[str, object]", tool)["ifgen"] = dict(values)
        try:
            if tomllib.loads(changed) == before:
                return changed
        except tomllib.TOMLDecodeError:  # `tool = {...}`, which nothing can be added to
            pass
    message = f"{shown_path(path)} has a `tool` to which no table can be added"
    raise _impossible(message, lines)


def with_attributes(text: str, output: PurePosixPath) -> str:
    """A .gitattributes that has lines for the output folder; those that it has for the same files stay."""
    pattern = re.sub(r"([\\*?\[])", r"\\\1", str(output))
    known = {match[1] for match in re.finditer(r'^[ \t]*("(?:[^"\\\n]|\\.)*"|[^\s"]\S*)', text, re.MULTILINE)}
    lines = ((_quoted(files.format(pattern)), words) for files, words in _ATTRIBUTES.items())
    return _appended(text, [f"{files} {words}" for files, words in lines if files not in known])


def with_hooks(path: Path, text: str, revision: str) -> str:
    """A .pre-commit-config.yaml that has our hooks. Raises UsageError if they cannot be added."""
    entry = [f"- repo: {REPOSITORY}", f"  rev: {revision}", "  hooks:"]
    entry += [f"    - id: {hook}" for hook in HOOKS]
    root = _composed(path, text)
    if root is None:
        return _appended(text, ["repos:", *(f"  {line}" for line in entry)])
    repos = _value(root, "repos")
    if not isinstance(repos, yaml.SequenceNode):
        raise _impossible(f"{shown_path(path)} has no list `repos`", ["repos:", *(f"  {e}" for e in entry)])
    if any(map(_is_ours, repos.value)):
        return text
    changed = _with_item(text, repos, entry)
    if changed is None or not (_adds_only(text, changed) and _ends_with_ours(_composed(path, changed))):
        raise _impossible(f"nothing can be added to the list `repos` of {shown_path(path)}", entry)
    return changed


def _toml(value: object) -> str:
    """A TOML value for a text or a list of texts: as in JSON, except for one character to escape."""
    return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")


def _quoted(pattern: str) -> str:
    """A pattern as .gitattributes needs it."""
    is_plain = not re.search(r"\s", pattern) and pattern[0] not in '"#!'
    return pattern if is_plain else json.dumps(pattern, ensure_ascii=False)


def _appended(text: str, lines: Sequence[str], *, gap: bool = False) -> str:
    """A text with lines at its end, and with its line ends; the same if there are none."""
    if not lines:
        return text
    line_end = _line_end(text)
    if text and not text.endswith("\n"):
        text += line_end
    if gap and text:
        text += line_end
    return text + "".join(line + line_end for line in lines)


def _line_end(text: str) -> str:
    return "\r\n" if "\r\n" in text else "\n"


def _composed(path: Path, text: str) -> yaml.Node | None:
    try:
        return yaml.compose(text, yaml.SafeLoader)
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark
        start = min(mark.index, max(len(text.rstrip()) - 1, 0)) if mark else 0
        label = Label(Span(Source(path, text), start, start + 1), str(error.problem))
    except (yaml.YAMLError, RecursionError, ValueError) as error:
        label = Label(Span(Source(path, text), 0, 0), type(error).__name__)
    raise UsageError([Diagnostic("configuration", f"{shown_path(path)} is not valid YAML", label)])


def _value(node: yaml.Node, key: str) -> yaml.Node | None:
    if not isinstance(node, yaml.MappingNode):
        return None
    values = [value for name, value in node.value if name.value == key]
    return values[-1] if values else None


def _is_ours(repository: yaml.Node) -> bool:
    """Whether an item of `repos` has a hook of ours, from wherever."""
    hooks = _value(repository, "hooks")
    items: list[yaml.Node] = hooks.value if isinstance(hooks, yaml.SequenceNode) else []
    return any((id_ := _value(hook, "id")) is not None and id_.value in HOOKS for hook in items)


def _ends_with_ours(root: yaml.Node | None) -> bool:
    repos = _value(root, "repos") if root is not None else None
    return isinstance(repos, yaml.SequenceNode) and _is_ours(repos.value[-1])


def _with_item(text: str, items: yaml.SequenceNode, entry: Sequence[str]) -> str | None:
    """A document with one more item in a list that has its own lines or is `[]`; None for any other list."""
    line_end = _line_end(text)
    start, end = items.start_mark, items.end_mark
    if not items.value:
        lines = "".join(f"{line_end}  {line}" for line in entry)
        return text[: start.index].rstrip(" \t") + lines + text[end.index :]
    if items.flow_style:
        return None
    last = max(node.end_mark.index for node in _leaves(items.value[-1]))
    at = last if text[last - 1 : last] == "\n" else text.find("\n", last) + 1
    before = text[:at] if at else text + line_end
    indent = " " * start.column
    return before + "".join(f"{indent}{line}{line_end}" for line in entry) + text[len(before) :]


def _leaves(node: yaml.Node) -> Iterator[yaml.Node]:
    """The nodes that end with their text. A block ends where the next node begins, after comments."""
    if isinstance(node, yaml.CollectionNode) and not node.flow_style:
        children = (
            itertools.chain.from_iterable(node.value) if isinstance(node, yaml.MappingNode) else node.value
        )
        for child in children:
            yield from _leaves(child)
    else:
        yield node


def _adds_only(text: str, changed: str) -> bool:
    """Whether one YAML document is another with something more in one place."""
    try:
        before, after = _events(text), _events(changed)
    except yaml.YAMLError:
        return False
    pairs = enumerate(zip(before, after, strict=False))
    same = next((i for i, (old, new) in pairs if old != new), len(before))
    return before[same:] == after[len(after) - len(before) + same :]


def _events(text: str) -> list[tuple[Any, ...]]:
    kept = ("anchor", "tag", "value")
    return [
        (type(event), *(getattr(event, name, None) for name in kept))
        for event in yaml.parse(text, yaml.SafeLoader)
    ]


def _impossible(message: str, lines: Sequence[str]) -> UsageError:
    written = "\n".join(f"    {line}" for line in lines)
    return UsageError([Diagnostic("configuration", message, help=f"add this by hand:\n{written}")])
