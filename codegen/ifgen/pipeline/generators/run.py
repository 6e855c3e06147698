"""Runs the targets of a run: what each generator makes, checked, by the folder that it goes into."""

from __future__ import annotations

import traceback
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path, PurePosixPath, PureWindowsPath
from typing import TypeVar

from ifgen.config.customization import Customization, Target
from ifgen.config.customization import Output as UsersOutput
from ifgen.diagnostics import Diagnostic, InputError, Label, Span, any_errors, shown_path
from ifgen.generator_py.outputs.plan import plan_outputs
from ifgen.generator_py.templates.parsed import wrong_text
from ifgen.generator_py.templates.render import Templates
from ifgen.generators import File, Finding, Generator, Request, Response
from ifgen.generators.protocol import generate_request
from ifgen.model import Model
from ifgen.pipeline.generators import narrowing
from ifgen.pipeline.generators.find import find, option_values
from ifgen.pipeline.generators.programs import failure, formatted
from ifgen.pipeline.model import BuiltModel
from ifgen.reading import manifest
from ifgen.writing.write import TargetFolder

Made = TypeVar("Made")


@dataclass(frozen=True, slots=True)
class TargetResult:
    """The files that the targets of a run make, by folder, and diagnostics about them."""

    folders: tuple[TargetFolder, ...]
    diagnostics: tuple[Diagnostic, ...]


def run_targets(
    targets: Sequence[Target], built: BuiltModel, ask: Callable[[Request], str] = generate_request
) -> TargetResult:
    """Run all targets; `ask` writes the request to a program. Raises InputError with all mistakes."""
    problems: list[Diagnostic] = []
    found: list[Diagnostic] = []
    made: dict[Path, dict[str, str | bytes]] = {}
    owners: dict[str, tuple[Target, File]] = {}
    for target in targets:
        try:
            files, diagnostics = _Run(target, built, ask).files()
        except InputError as error:
            problems += error.diagnostics
            continue
        found += diagnostics
        folder = made.setdefault(target.out, {})
        for file in files:
            path = str((target.out / file.path).absolute()).casefold()  # one file on some disks
            owner, _ = owners.setdefault(path, (target, file))
            if owner is not target:
                message = f"generators '{owner.name}' and '{target.name}' both write {file.path}"
                advice = "choose another `out` for one of them"
                problems.append(failure(target.place("out"), message, advice))
            folder[file.path] = file.content
    problems += _files_in_files(owners)
    if problems:
        raise InputError([*problems, *found])
    return TargetResult(tuple(TargetFolder(out, files) for out, files in made.items()), tuple(found))


def _files_in_files(owners: Mapping[str, tuple[Target, File]]) -> Iterator[Diagnostic]:
    for path, (target, file) in owners.items():
        for parent in Path(path).parents:
            if found := owners.get(str(parent)):
                owner, other = found
                message = f"generator '{target.name}' writes {file.path}, but {other.path} is a file"
                message += f" of generator '{owner.name}'" if owner is not target else ", too"
                yield failure(target.place("out"), message)


class _Run:
    """One target."""

    def __init__(self, target: Target, built: BuiltModel, ask: Callable[[Request], str]) -> None:
        self._target = target
        self._spans = built.spans
        self._place = target.place("command" if target.command else "use")
        self._generator = find(target, ask)
        self._options = option_values(target, self._generator)
        self._skipped: list[Diagnostic] = []
        self._request = Request(self._narrowed(built.model), self._options, target.name)

    def files(self) -> tuple[tuple[File, ...], tuple[Diagnostic, ...]]:
        """The files, and diagnostics that are no errors. Raises InputError."""
        generator = self._generator
        findings: tuple[Finding, ...] = self._called(generator.check) if generator.check else ()
        files: list[File] = []
        said = [self._diagnostic(finding) for finding in findings]
        if self._target.templates is not None:
            self._check_templates(self._target.templates)
        if not any_errors(said) and generator.outputs:
            files += self._from_templates(generator)
        if not any_errors(said) and generator.generate:
            response: Response = self._called(generator.generate)
            said += map(self._diagnostic, response.findings)
            files += response.files
        errors = [each for each in said if each.severity == "error"]
        errors += self._wrong_files(files)
        if errors:
            raise InputError(errors)
        return tuple(formatted(self._target, files)), (*self._skipped, *said)

    def _narrowed(self, model: Model) -> Model:
        target, generator = self._target, self._generator
        if unmatched := narrowing.unmatched(model, target.only):
            raise InputError(
                failure(
                    target.place("only"), f"target '{target.name}': '{pattern}' in `only` matches nothing"
                )
                for pattern in unmatched
            )
        chosen = narrowing.wanted(model, target.only, with_deps=target.with_deps)
        lacking = list(narrowing.lacking(model, narrowing.with_needed(model, chosen), generator))
        if lacking and target.unsupported == "error":
            raise InputError(self._unsupported(id_, feature) for _, id_, feature in lacking)
        left_out: dict[str, str] = {}
        for name, id_, feature in lacking:
            if name not in left_out:
                self._skipped.append(self._unsupported(id_, feature, name))
            left_out.setdefault(name, feature)
        whole = {name for name in chosen if left_out.keys().isdisjoint(narrowing.with_needed(model, [name]))}
        return narrowing.narrowed(model, whole, target.only)

    def _unsupported(self, id_: str, feature: str, skipped: str | None = None) -> Diagnostic:
        span, generator = self._spans.get(id_), self._generator
        version = f" {generator.version}" if generator.version else ""
        message = f"generator '{generator.name}'{version} does not support {feature}: {id_}"
        return Diagnostic(
            "unsupported-feature",
            message if skipped is None else f"{message}; {skipped} is left out",
            None if span is None else Label(span),
            help='`unsupported = "skip"` leaves it out, and what needs it' if skipped is None else None,
            severity="error" if skipped is None else "warning",
        )

    def _called(self, function: Callable[[Request], Made]) -> Made:
        """The result of a function of a generator. Raises InputError, whatever that raises."""
        try:
            return function(self._request)
        except InputError:
            raise
        except Exception as error:
            *_, frame = traceback.extract_tb(error.__traceback__)
            place = f"{Path(frame.filename).name}:{frame.lineno}"
            message = f"generator '{self._generator.name}' failed: {type(error).__name__}: {error} ({place})"
            raise InputError([failure(self._place, message)]) from error

    def _from_templates(self, generator: Generator) -> Iterator[File]:
        outputs = tuple(
            UsersOutput(f"{generator.name}: {o.template}", o.template, o.path, o.per, span=self._place)
            for o in generator.outputs
        )
        custom = _set_of(generator, self._target, outputs)
        model = self._request.model
        packages = [
            replace(package, interfaces=tuple(i for i in package.interfaces if i.generate))
            for package in model.packages
            if package.generate
        ]
        variables = {"model": model, "options": self._options}
        templates = Templates(custom)
        for planned in plan_outputs(outputs, packages, {}, variables, own_folder=True):
            yield File(planned.artifact.path, templates.render(planned.artifact).text)

    def _check_templates(self, folder: Path) -> None:
        name = self._generator.name
        if self._generator.templates is None:
            message = f"generator '{name}' has no templates that '{shown_path(folder)}' could replace"
            copied = f"`ifgen generators new NAME --from {name}` makes a copy that you can change"
            advice = None if self._target.command else copied
            raise InputError([failure(self._target.place("templates"), message, advice)])

    def _diagnostic(self, finding: Finding) -> Diagnostic:
        span = self._spans.get(finding.element) if finding.element else None
        if finding.element and span is None and finding.element not in _ids(self._request.model):
            name, element = self._generator.name, finding.element
            message = f"generator '{name}' names an element that is not in the model: {element!r}"
            return failure(self._place, message, f"it says: {finding.message}")
        place: Span | None = span or self._place
        about = "" if span is not None or finding.element is None else f" ({finding.element})"
        return Diagnostic(
            "generator",
            f"{self._generator.name}: {finding.message}{about}",
            None if place is None else Label(place),
            help=finding.help,
            severity=finding.severity,
        )

    def _wrong_files(self, files: Sequence[File]) -> Iterator[Diagnostic]:
        seen: set[str] = set()
        for file in files:
            if wrong := _wrong_path(file.path):
                message = f"generator '{self._generator.name}' wants to write {file.path!r}: {wrong}"
                yield failure(self._place, message)
            elif file.path.casefold() in seen:
                message = f"generator '{self._generator.name}' writes {file.path} twice"
                yield failure(self._place, message)
            elif isinstance(file.content, str):
                problem = wrong_text(file.path, file.content, f"generator '{self._generator.name}'")
                yield from [problem] if problem else []
            seen.add(file.path.casefold())


def _ids(model: Model) -> Iterator[str]:
    """The ids of all elements; those of derived messages have no place in a file."""
    for package in model.packages:
        yield from (interface.id for interface in package.interfaces)
    for message in model.types:
        yield message.id
        yield from (field.id for field in message.fields)
        yield from (constant.id for constant in message.constants)


def _set_of(generator: Generator, target: Target, outputs: tuple[UsersOutput, ...]) -> Customization:
    """The templates of a generator, with those of the user's in front of them."""
    if target.templates is None:
        return Customization(generator.templates, generator.filters, outputs)
    behind, name = generator.templates, generator.name
    return Customization(target.templates, generator.filters, outputs, behind=behind, behind_name=name)


def _wrong_path(text: str) -> str | None:
    """The mistake in a path inside a folder; None if it is right."""
    path = PurePosixPath(text)
    if path.is_absolute() or PureWindowsPath(text).drive or ".." in path.parts:
        return "that is outside its folder"
    if not path.name or str(path) != text or "\\" in text or not text.isprintable():
        return "that is not the plain path of a file"
    if path.name in {manifest.NAME, manifest.TARGETS}:
        return "that is ifgen's own list of files"
    return None
