"""Checks a user's templates before anything is rendered: each is used, parses, and fits what it is given."""

from __future__ import annotations

import re
from collections.abc import Container, Iterable, Iterator
from pathlib import Path

import jinja2
import jinja2.meta

from ifgen import resources
from ifgen.config.customization import Customization, Output
from ifgen.diagnostics import Diagnostic, InputError, Label, Source, Span, did_you_mean
from ifgen.generator_py.templates.check.check import Checker
from ifgen.generator_py.templates.check.syntax import Template, parse, refusal
from ifgen.generator_py.templates.check.types import spelled
from ifgen.generator_py.templates.exports import conflicts, files
from ifgen.generator_py.templates.table import OUTPUT_VARIABLES, TEMPLATES
from ifgen.reading.storage import MAX_GENERATED, read_limited

_OURS = "ifgen/"
_SUFFIX = ".j2"
# After a line that has text: with nothing but a tag before it, there is no line break left to remove.
_TRIMMED = re.compile(r"^[^{\n]*[^{\s][^{\n]*\n[ \t]*(\{%-)", re.MULTILINE)
_NAMES = re.compile(r"""["']([^"'{}%]+)["']""")


def problems(environment: jinja2.Environment, custom: Customization) -> list[Diagnostic]:
    """Everything that is wrong with the templates in a folder of the user's, or with ours; also warnings."""
    return _Check(environment, custom).problems()


def given(environment: jinja2.Environment) -> dict[str, dict[str, str]]:
    """The names that each template of ours has, and their types, by template."""
    checker = _Check(environment, Customization()).checked(TEMPLATES)
    spellings = {t: {name: spelled(type_) for name, type_ in n.items()} for t, n in checker.given.items()}
    return {t: {name: type_ for name, type_ in n.items() if type_} for t, n in spellings.items()}


class _Check:
    def __init__(self, environment: jinja2.Environment, custom: Customization) -> None:
        self._environment = environment
        self._custom = custom
        self._ours = files(resources.templates())
        self._own = {name: path for folder in custom.folders for name, path in files(folder).items()}
        self._paths = {**{_OURS + name: path for name, path in self._ours.items()}, **self._ours, **self._own}
        if custom.behind is not None and custom.behind_name is not None:
            originals = files(custom.behind)
            self._paths |= {f"{custom.behind_name}/{name}": path for name, path in originals.items()}
        self._parsed: dict[str, Template] = {}

    def problems(self) -> list[Diagnostic]:
        if conflicts := [found for path in self._own.values() for found in _conflicts(path)]:
            return conflicts  # what else there is to say would be about their marks
        found = [_unknown(o, self._paths) for o in self._custom.outputs if o.template not in self._paths]
        found += filter(None, map(_trimmed, self._own.values()))
        found += [self._replaces_nothing(name) for name in self._unused()]
        touched = [name for name in TEMPLATES if not self._own.keys().isdisjoint(self._used_by(name))]
        found += self.checked(touched if self._own or self._custom.outputs else TEMPLATES).found()
        return [*found, *self._refused({d.primary.span.source.path for d in found if d.primary})]

    def checked(self, roots: Iterable[str]) -> Checker:
        """A checker that has checked these templates of ours, as far as they exist, and those of outputs."""
        checker = Checker(self._environment, self._load, self._paths)
        for name in roots:
            if name in self._paths:
                checker.check(name, TEMPLATES[name].variables)
        for output in self._custom.outputs:
            if output.template in self._paths:
                checker.check(output.template, OUTPUT_VARIABLES[output.per])
        return checker

    def _load(self, name: str) -> Template | None:
        if name not in self._parsed and name in self._paths:
            self._parsed[name] = parse(name, self._paths[name], self._environment)
        return self._parsed.get(name)

    def _refused(self, broken: Container[Path]) -> Iterator[Diagnostic]:
        """Other errors of jinja2, in the user's templates of which nothing else is known."""
        for name, path in self._own.items():
            template = self._parsed.get(name)
            if template is not None and path not in broken:
                problem = refusal(template, self._environment)
                yield from [problem] if problem else []

    def _replaces_nothing(self, name: str) -> Diagnostic:
        whose, advice = self._custom.behind_name or "ifgen", "`ifgen templates list` names all of them"
        others: Iterable[str] = self._ours
        if self._custom.behind_name is not None and self._custom.behind is not None:
            others, advice = files(self._custom.behind), f"`ifgen generators describe {whose}` names them"
        advice = did_you_mean(name, others, form="{}") or advice
        message = (
            f"{self._own[name]} replaces nothing: {whose} has no template {name}, and none of yours uses it"
        )
        return Diagnostic("unused-template", message, help=advice)

    def _used_by(self, root: str) -> set[str]:
        """A template and all that it and they name: more than they use, perhaps, but nothing is left out."""
        found: set[str] = set()
        pending = [root]
        while pending:
            name = pending.pop()
            if name not in found and name in self._paths:
                found.add(name)
                pending += _NAMES.findall(_text(self._paths[name]))
        return found

    def _unused(self) -> Iterator[str]:
        """Templates of the user's that replace none of ours, and that no output and no other one uses."""
        used = {*self._ours, *(output.template for output in self._custom.outputs)}
        pending = [name for name in self._own if name in used]
        while pending:
            try:
                template = self._load(pending.pop())
            except InputError:  # reported when it is checked
                continue
            for name in jinja2.meta.find_referenced_templates(template.tree) if template else ():
                if name is None:
                    return  # computed: it may be any
                if name in self._own and name not in used:
                    pending.append(name)
                used.add(name)
        # Other files may stand beside templates, unless one lacks only the extension of a template of ours.
        suspects = (name for name in self._own if name.endswith(_SUFFIX) or name + _SUFFIX in self._ours)
        yield from (name for name in suspects if name not in used)


def _text(path: Path) -> str:
    """The text of a template, or of a file beside templates."""
    return read_limited(path, MAX_GENERATED).decode("utf-8", "replace")


def _conflicts(path: Path) -> Iterator[Diagnostic]:
    """The leftover marks of a merge in a template."""
    source = Source(path, _text(path))
    for start in conflicts(source.text):
        label = Label(Span(source, start, start + len("<<<<<<<")), "it begins here")
        message = "this template has a conflict that is not resolved"
        yield Diagnostic("template-syntax", message, label, help="keep what you want, and delete the marks")


def _trimmed(path: Path) -> Diagnostic | None:
    """Warn of a tag that begins a line and takes the line break before it away: lines run together."""
    source = Source(path, _text(path))
    match = _TRIMMED.search(source.text)
    if match is None:
        return None
    label = Label(Span(source, match.start(1), match.end(1)), "this joins the line to the one before")
    advice = "write `{%`: ifgen removes the line of a tag that stands alone, as trim_blocks of jinja2 does"
    message = "`{%-` removes the line break before it"
    return Diagnostic("trimmed-line", message, label, help=advice, severity="warning")


def _unknown(output: Output, known: dict[str, Path]) -> Diagnostic:
    hint = did_you_mean(output.template, known, form="{}")
    advice = hint or "ifgen looks for it in `templates` of [tool.ifgen]"
    message = f"output '{output.name}' cannot be made: there is no template {output.template}"
    return Diagnostic("unknown-template", message, output.label("template"), help=advice)
