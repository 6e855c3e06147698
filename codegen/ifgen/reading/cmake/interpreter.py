"""Runs the statements of CMake files: calls, conditions, loops, and the files that they include."""

from __future__ import annotations

from collections.abc import Generator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final, Literal

from ifgen.diagnostics import InputError, Source
from ifgen.reading import storage
from ifgen.reading.cmake import builtin, loops
from ifgen.reading.cmake.blocks import Block, Statement, commands_in
from ifgen.reading.cmake.calls import Call
from ifgen.reading.cmake.conditions import Answer, Asked, holds
from ifgen.reading.cmake.keywords import parsed as by_keyword
from ifgen.reading.cmake.program import Program, parsed
from ifgen.reading.cmake.state import State
from ifgen.reading.cmake.text import Command, SyntaxProblem
from ifgen.reading.cmake.values import EMPTY, Doubt, Value, elements, joined, worse
from ifgen.reading.cmake.words import Word, doubt_of, texts
from ifgen.reading.storage import read_source

GENERATE: Final = "rosidl_generate_interfaces"

_MAX_CALLS: Final = 20
_MAX_INCLUDED: Final = 49
_OPTIONS: Final = ("ADD_LINTER_TESTS", "SKIP_INSTALL", "SKIP_GROUP_MEMBERSHIP_CHECK")

Ending = Literal["return", "break", "continue"] | None


@dataclass(frozen=True, slots=True)
class _Definition:
    """A function or a macro, and the file that it stands in."""

    block: Block
    parameters: tuple[str, ...]
    source: Source


class Interpreter:
    """Follows CMake files, from one CMakeLists.txt on.

    `calls` are what it found, `unsure` why there may be others, `included` the other files that were read.
    """

    def __init__(self, state: State) -> None:
        self.calls: list[Call] = []
        self.unsure: Doubt | None = None
        self.included: list[Source] = []
        self._state = state
        self._variables = state.variables
        self._depth = 0
        self._definitions: dict[str, _Definition] = {}

    def run(self, program: Program, folder: Path | None = None) -> None:
        """Follow a program; one in a folder of its own has variables of its own. Raises ExhaustedError."""
        path, before = program.source.path, self._state.folder
        of_file = {
            "CMAKE_CURRENT_LIST_FILE": Value(path.as_posix()),
            "CMAKE_CURRENT_LIST_DIR": Value(path.parent.as_posix()),
        }
        if folder is not None:
            of_file["CMAKE_CURRENT_SOURCE_DIR"] = Value(folder.as_posix())
        self._state.folder = folder or before
        self._within(of_file, folder is None, program.statements, program.source)
        self._state.folder = before

    def _within(
        self, values: Mapping[str, Value], of_macro: bool, statements: Sequence[Statement], source: Source
    ) -> None:
        """Do statements that see some variables of their own."""
        with self._variables.scope(values, of_macro):
            self._statements(statements, source)

    def _statements(self, statements: Sequence[Statement], source: Source) -> Ending:
        for statement in statements:
            if isinstance(statement, Command):
                ending = self._command(statement, source)
            else:
                self._state.at(source, statement.command)
                ending = self._block(statement, source)
            if ending is not None:
                return ending
        return None

    def _command(self, command: Command, source: Source) -> Ending:
        self._state.at(source, command)
        definition = self._definitions.get(command.name)
        words = self._state.words(command.arguments)
        match command.name:
            case "return" | "break" | "continue":
                return command.name
            case "include":
                self._include(words)
            case "add_subdirectory":
                self._add_subdirectory(words)
            case name if name == GENERATE and definition is None:
                self._generate(words)
            case _ if definition is not None:
                self._invoke(definition, words)
            case name:
                builtin.call(name, self._state, words)
        return None

    def _block(self, block: Block, source: Source) -> Ending:
        match block.command.name:
            case "if":
                return self._if(block, source)
            case "foreach":
                return self._foreach(block, source)
            case "while":
                return self._while(block, source)
            case "block":
                return self._statements(block.body, source)
            case _:  # function or macro
                name, *parameters = texts(self._state.words(block.command.arguments)) or [""]
                self._definitions[name.lower()] = _Definition(block, tuple(parameters), source)
                return None

    def _if(self, block: Block, source: Source) -> Ending:
        branches = [block, *block.otherwise]
        doubt: Doubt | None = None
        for number, branch in enumerate(branches):
            self._state.at(source, branch.command)
            answer = Answer(True) if branch.command.name == "else" else self._holds(branch.command)
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

    def _foreach(self, block: Block, source: Source) -> Ending:
        names, rows, doubt = loops.turns(self._state, self._state.words(block.command.arguments))
        if doubt is not None:
            self._suspect([block], doubt)
        for row in rows:
            self._state.at(source, block.command)
            for name, item in zip(names, row, strict=False):
                self._variables.set(name, Value(item, doubt))
            ending = self._statements(block.body, source)
            if ending == "return":
                return ending
            if ending == "break":
                break
        return None

    def _while(self, block: Block, source: Source) -> Ending:
        while True:
            self._state.at(source, block.command)
            answer = self._holds(block.command)
            if answer.doubt is not None:
                self._suspect([block], replace(answer.doubt, lost=True))
                return None
            ending = self._statements(block.body, source) if answer.holds else "break"
            if ending in {"return", "break"}:
                return "return" if ending == "return" else None

    def _holds(self, command: Command) -> Answer:
        state = self._state
        asked = Asked(self._variables.get, self._has_command, state.doubt, state.regex, state.folder)
        return holds(state.words(command.arguments), asked)

    def _has_command(self, name: str) -> bool:
        return name in self._definitions or name == GENERATE

    def _suspect(self, branches: Sequence[Block], doubt: Doubt) -> None:
        """Whatever the branches may set is in doubt from now on, and so is whether they generate anything."""
        for command in (command for branch in branches for command in commands_in(branch.body)):
            self._state.spend(20)
            if command.name in {GENERATE, "return"} or command.name in self._definitions:
                self.unsure = self.unsure or doubt
            if command.name in builtin.SETTERS or command.name in self._definitions:
                builtin.suspect(self._state, self._state.words(command.arguments), doubt)

    @contextmanager
    def _assuming(self, doubt: Doubt | None) -> Generator[None]:
        """Within, everything that is set is in doubt, if there is one."""
        before = self._variables.assumption
        self._variables.assumption = worse(before, doubt)
        try:
            yield
        finally:
            self._variables.assumption = before

    def _invoke(self, definition: _Definition, words: list[Word]) -> None:
        if self._depth == _MAX_CALLS:
            return
        self._depth += 1
        named = dict(zip(definition.parameters, words, strict=False))
        values = {name: Value(word.text, word.doubt) for name, word in named.items()}
        rest = words[len(definition.parameters) :]
        values["ARGC"] = Value(str(len(words)))
        values["ARGV"] = Value(joined(texts(words)), doubt_of(words))
        values["ARGN"] = Value(joined(texts(rest)), doubt_of(rest))
        values |= {f"ARGV{number}": Value(word.text, word.doubt) for number, word in enumerate(words)}
        of_macro = definition.block.command.name == "macro"
        self._within(values, of_macro, definition.block.body, definition.source)
        self._depth -= 1

    def _include(self, words: list[Word]) -> None:
        name = words[0].text if words else ""
        path = self._state.folder / name
        if "." not in Path(name).name:  # a module, of the package or of somebody else
            folders = elements(self._value("CMAKE_MODULE_PATH").text)
            modules = (self._state.folder / folder / f"{name}.cmake" for folder in folders)
            path = next((module for module in modules if storage.is_file(module)), path)
        self.follow(path)

    def _add_subdirectory(self, words: list[Word]) -> None:
        folder = self._state.folder / (words[0].text if words else "")
        if not storage.exists(folder / "package.xml"):  # that is a package by itself
            self.follow(folder / "CMakeLists.txt", folder)

    def follow(self, path: Path, folder: Path | None = None) -> None:
        """Do what another file says; one that is not there says nothing. Raises ExhaustedError."""
        if self._depth == _MAX_CALLS or len(self.included) == _MAX_INCLUDED:
            return
        self._depth += 1
        try:
            source = read_source(path)
            self.included.append(source)
            self.run(parsed(source, self._state.spend), folder)
        except SyntaxProblem as problem:
            self.unsure = self._state.doubt(f"{path.name} is not CMake ({problem})", lost=True)
        except (InputError, ValueError):
            pass  # a module of CMake's own, or of another package
        self._depth -= 1

    def _generate(self, words: list[Word]) -> None:
        target, *rest = words or [Word("", False)]
        said = [item for text in texts(rest) for item in elements(text)]
        found = by_keyword(said, _OPTIONS, ("LIBRARY_NAME",), ("DEPENDENCIES",))
        at = next((at for at, word in enumerate(rest) if word.text == "DEPENDENCIES"), len(rest))
        skips = {"SKIP_INSTALL", "SKIP_GROUP_MEMBERSHIP_CHECK"} & found.keys()
        self.calls.append(
            Call(
                self._state.folder,
                tuple(found[""]),
                tuple(found.get("DEPENDENCIES", ())),
                self._state.span,
                worse(self._variables.assumption, target.doubt, doubt_of(rest[:at])),
                doubt_of(rest[at:]) is None,
                not skips,
            )
        )

    def _value(self, name: str) -> Value:
        return self._variables.get(name) or EMPTY
