"""Follows a CMake file as far as it decides what `rosidl_generate_interfaces` is called with; runs nothing.

What only a build knows (the answer of another program, what a package that is looked for defines) leaves a
doubt, which stays with every value that comes of it. So does what is not understood.
"""

from __future__ import annotations

import re
from collections.abc import Generator, Iterable, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Final, Literal

from ifgen.diagnostics import InputError, Source, Span
from ifgen.reading import storage
from ifgen.reading.cmake import commands
from ifgen.reading.cmake.conditions import Answer, evaluate
from ifgen.reading.cmake.state import ExhaustedError, State, Variables
from ifgen.reading.cmake.text import Block, Command, Statement, SyntaxProblem, commands_in, statements
from ifgen.reading.cmake.values import Doubt, Value, by_keyword, elements, texts, worse, worst_in

GENERATE: Final = "rosidl_generate_interfaces"

_NUMBER: Final = re.compile(r"-?[0-9]{1,9}")
_MAX_CALLS: Final = 20
_MAX_INCLUDED: Final = 49
_OPTIONS: Final = ("ADD_LINTER_TESTS", "SKIP_INSTALL", "SKIP_GROUP_MEMBERSHIP_CHECK")

Ending = Literal["return", "break", "continue"] | None


@dataclass(frozen=True, slots=True)
class Call:
    """A call of `rosidl_generate_interfaces`, with its files as they are passed, relative to `folder`.

    `checks_group` is true if rosidl requires the package to be in the group rosidl_interface_packages.
    """

    folder: Path
    files: tuple[str, ...]
    dependencies: tuple[str, ...]
    span: Span
    doubt: Doubt | None
    dependencies_are_known: bool
    checks_group: bool


@dataclass(frozen=True, slots=True)
class Followed:
    """The calls that were found in `sources`, the files that were read, and why there may be others."""

    calls: tuple[Call, ...]
    sources: tuple[Source, ...]
    unsure: Doubt | None


def follow(source: Source, folder: Path, shares: Sequence[Path]) -> Followed:
    """Follow the CMakeLists.txt of a folder and what it includes. Packages are installed in `shares`."""
    interpreter = _Interpreter(State(folder, _Extras(shares).variable))
    try:
        interpreter.run(source)
    except SyntaxProblem as error:
        doubt = Doubt(str(error), Span(source, error.offset, error.offset + 1), True)
        return Followed((), (source,), doubt)
    except ExhaustedError:
        return Followed((), (source,), Doubt("it runs too many commands", Span(source, 0, 0), True))
    return Followed(tuple(interpreter.calls), (source, *interpreter.included), interpreter.unsure)


class _Extras:
    """The variables that installed packages bring in CMake files of their own; followed when asked."""

    def __init__(self, shares: Sequence[Path]) -> None:
        self._shares = shares
        self._packages: dict[str, Variables | None] = {}

    def variable(self, package: str, name: str) -> Value | None:
        """The value of a variable that a package brings, if it does."""
        if package not in self._packages:
            self._packages[package] = None
            paths = (share / package / "cmake" / f"{package}-extras.cmake" for share in self._shares)
            path = next((path for path in paths if storage.is_file(path)), None)
            if path is not None:
                state = State(path.parent, lambda package, name: None)
                state.variables.set(f"{package}_DIR", Value(path.parent.as_posix()))
                with suppress(ExhaustedError):
                    _Interpreter(state).include(path)
                self._packages[package] = state.variables
        extras = self._packages[package]
        return extras.get(name) if extras else None


@dataclass(frozen=True, slots=True)
class _Definition:
    """A function or a macro, and the file that it stands in."""

    block: Block
    parameters: tuple[str, ...]
    source: Source


class _Interpreter:
    """A run; `calls` are what it found, `unsure` why there may be others, `included` the other files read."""

    def __init__(self, state: State) -> None:
        self.calls: list[Call] = []
        self.unsure: Doubt | None = None
        self.included: list[Source] = []
        self._state = state
        self._variables = state.variables
        self._depth = 0
        self._definitions: dict[str, _Definition] = {}

    def run(self, source: Source, folder: Path | None = None) -> None:
        """Follow a file; one in a folder of its own has variables of its own.

        Raises SyntaxProblem, ExhaustedError.
        """
        program = statements(source.text)
        self._state.spend(len(source.text) // 10)
        before = self._state.folder
        variables = {
            "CMAKE_CURRENT_LIST_FILE": Value(source.path.as_posix()),
            "CMAKE_CURRENT_LIST_DIR": Value(source.path.parent.as_posix()),
        }
        if folder is not None:
            variables["CMAKE_CURRENT_SOURCE_DIR"] = Value(folder.as_posix())
        self._state.folder = folder or before
        with self._variables.scope(variables, of_macro=folder is None):
            self._statements(program, source)
        self._state.folder = before

    def include(self, path: Path, folder: Path | None = None) -> None:
        """Do what another file says; one that is not there says nothing. Raises ExhaustedError."""
        if self._depth == _MAX_CALLS or len(self.included) == _MAX_INCLUDED:
            return
        self._depth += 1
        try:
            source = storage.read_source(path)
            self.included.append(source)
            self.run(source, folder)
        except SyntaxProblem as problem:
            self.unsure = self._state.doubt(f"{path.name} is not CMake ({problem})", lost=True)
        except (InputError, ValueError):
            pass  # a module of CMake's own, or of another package
        self._depth -= 1

    def _statements(self, statements: Iterable[Statement], source: Source) -> Ending:
        for statement in statements:
            ending: Ending
            if isinstance(statement, Command):
                ending = self._command(statement, source)
            elif statement.command.name == "if":
                ending = self._if(statement, source)
            else:
                ending = self._block(statement, source)
            if ending is not None:
                return ending
        return None

    def _command(self, command: Command, source: Source) -> Ending:
        words = self._state.enter(source, command)
        match command.name:
            case "return" | "break" | "continue":
                return command.name
            case "include":
                self._include(words)
            case "add_subdirectory":
                folder = self._state.folder / (words[0].text if words else "")
                if not storage.exists(folder / "package.xml"):  # that is a package by itself
                    self.include(folder / "CMakeLists.txt", folder)
            case name if name in self._definitions:
                self._invoke(self._definitions[name], words)
            case name if name == GENERATE:
                self._generate(words)
            case name:
                commands.call(name, self._state, words)
        return None

    def _block(self, block: Block, source: Source) -> Ending:
        words = self._state.enter(source, block.command)
        match block.command.name:
            case "foreach":
                return self._foreach(block, words, source)
            case "while":  # no interface package counts
                self._suspect([block], self._state.doubt("the effect of while here is not known", lost=True))
            case "block":
                return self._statements(block.body, source)
            case _:  # function or macro
                name, *parameters = texts(words) or [""]
                self._definitions[name.lower()] = _Definition(block, tuple(parameters), source)
        return None

    def _if(self, block: Block, source: Source) -> Ending:
        branches = [block, *block.otherwise]
        doubt: Doubt | None = None
        for number, branch in enumerate(branches):
            words = self._state.enter(source, branch.command)
            answer = Answer(True)
            if branch.command.name != "else":
                answer = evaluate(words, self._state, {*self._definitions, GENERATE})
            if answer.doubt is not None:
                doubt = worse(doubt, answer.doubt)
                self._suspect(branches[number:], answer.doubt)
            if answer.holds:
                with self._assuming(doubt):
                    ending = self._statements(branch.body, source)
                if ending is not None:
                    self.unsure = self.unsure or doubt
                return ending
        return None

    def _foreach(self, block: Block, words: Sequence[Value], source: Source) -> Ending:
        name, *rest = texts(words) or [""]
        items, doubt = self._items(rest)
        doubt = worse(worst_in(words), doubt)
        if doubt is not None:
            self._suspect([block], doubt)
        for item in items:
            self._state.enter(source, block.command)
            self._variables.set(name, Value(item, doubt))
            ending = self._statements(block.body, source)
            if ending == "return":
                return ending
            if ending == "break":
                break
        return None

    def _items(self, words: Sequence[str]) -> tuple[Sequence[str], Doubt | None]:
        """The values for the variable of `foreach(NAME WORDS)`, and what is not sure about them."""
        match words:
            case ["IN", *_]:
                given = by_keyword(words[1:], (), (), ("LISTS", "ITEMS"))
                lists = [self._variables.value(name) for name in given.get("LISTS", ())]
                self._state.spend(sum(len(value.text) for value in lists))
                items = [item for value in lists for item in elements(value.text, keep_empty=True)]
                return [*items, *given.get("ITEMS", ())], worst_in(lists)
            case ["RANGE", *limits] if 0 < len(limits) < 4 and all(map(_NUMBER.fullmatch, limits)):
                first, last, *step = map(int, ["0", *limits] if len(limits) == 1 else limits)
                numbers = range(first, last + 1, max([1, *step]))
                self._state.spend(20 * len(numbers))
                return [str(number) for number in numbers], None
            case [_, "IN", *_] | ["RANGE", *_]:  # several lists at once
                return [], self._state.doubt("the effect of foreach here is not known", lost=True)
            case _:
                return words, None

    def _suspect(self, branches: Sequence[Block], doubt: Doubt) -> None:
        """Whatever the branches may set is in doubt from now on, and so is whether they generate anything."""
        for command in (command for branch in branches for command in commands_in(branch.body)):
            self._state.spend(20)
            if command.name in {GENERATE, "return"} or command.name in self._definitions:
                self.unsure = self.unsure or doubt
            if command.name in commands.SETTERS or command.name in self._definitions:
                self._state.suspect(self._state.words(command), doubt)

    @contextmanager
    def _assuming(self, doubt: Doubt | None) -> Generator[None]:
        """Within, everything that is set is in doubt, if there is one."""
        before = self._variables.assumption
        self._variables.assumption = worse(before, doubt)
        try:
            yield
        finally:
            self._variables.assumption = before

    def _invoke(self, definition: _Definition, words: Sequence[Value]) -> None:
        if self._depth == _MAX_CALLS:
            return
        self._depth += 1
        rest = words[len(definition.parameters) :]
        arguments: Mapping[str, Value] = {
            **dict(zip(definition.parameters, words, strict=False)),
            **{f"ARGV{number}": word for number, word in enumerate(words)},
            "ARGC": Value(str(len(words))),
            "ARGV": Value(";".join(texts(words)), worst_in(words)),
            "ARGN": Value(";".join(texts(rest)), worst_in(rest)),
        }
        block = definition.block
        with self._variables.scope(arguments, of_macro=block.command.name == "macro"):
            self._statements(block.body, definition.source)
        self._depth -= 1

    def _include(self, words: Sequence[Value]) -> None:
        name = words[0].text if words else ""
        path = self._state.folder / name
        if "." not in path.name:  # a module, of the package or of somebody else
            folders = elements(self._variables.value("CMAKE_MODULE_PATH").text)
            modules = (self._state.folder / folder / f"{name}.cmake" for folder in folders)
            path = next((module for module in modules if storage.is_file(module)), path)
        self.include(path)

    def _generate(self, words: Sequence[Value]) -> None:
        rest = words[1:]
        said = [item for text in texts(rest) for item in elements(text)]
        arguments = by_keyword(said, _OPTIONS, ("LIBRARY_NAME",), ("DEPENDENCIES",))
        at = next((at for at, word in enumerate(rest) if word.text == "DEPENDENCIES"), len(rest))
        self.calls.append(
            Call(
                folder=self._state.folder,
                files=tuple(arguments[""]),
                dependencies=tuple(arguments.get("DEPENDENCIES", ())),
                span=self._state.span,
                doubt=worse(self._variables.assumption, worst_in(words[: at + 1])),
                dependencies_are_known=worst_in(rest[at:]) is None,
                checks_group=not {"SKIP_INSTALL", "SKIP_GROUP_MEMBERSHIP_CHECK"} & arguments.keys(),
            )
        )
