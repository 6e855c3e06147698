"""`[tool.ifgen]` in pyproject.toml, the only configuration: its keys."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, cast, get_args

from ifgen import resources
from ifgen.config.customization import Output, Target
from ifgen.config.keys import (
    CODE,
    FLAG,
    PATH,
    PATHS,
    Kind,
    Mistake,
    key,
    list_of,
    mistakes,
    one_of,
    read,
    table_of,
    text,
)
from ifgen.config.suppressions import RosDistro
from ifgen.diagnostics import Span, UsageError
from ifgen.reading.storage import read_json

if TYPE_CHECKING:
    from ifgen.reading.search_path import WithDeps

# Late imports: what a command without a configuration does without, or with one that is cached.

_WITH_DEPS: Final = Kind(
    'true, false or "own"', lambda value: () if isinstance(value, bool) or value == "own" else (value,)
)
_OUTPUTS: Final = Kind(
    "a table, whose keys are names for outputs",
    lambda value: () if isinstance(value, dict) else (value,),
    lambda tables, base: {name: Output(name, **read(Output, table, base)) for name, table in tables.items()},
    Output,
)
_TARGETS: Final = Kind(
    "a table, whose keys are names for targets",
    lambda value: () if isinstance(value, dict) else (value,),
    lambda tables, base: {
        name: Target(name, **read(Target, table, base), base=base) for name, table in tables.items()
    },
    Target,
)
_DISTRIBUTIONS: Final = text(
    'a name with {package} in it, such as "acme-{package}"',
    r"([A-Za-z0-9][A-Za-z0-9._-]*)?\{package\}([A-Za-z0-9._-]*[A-Za-z0-9])?",
)
_REQUIREMENTS: Final = table_of(
    # Empty, or as PEP 508 begins. pip reads the rest.
    text("", r"([A-Za-z0-9]([A-Za-z0-9._-]*[A-Za-z0-9])? *([\[<>=!~;@(].*)?)?"),
    'a table of what pip installs, such as {nav2_msgs = "acme-nav2-msgs>=1.2"}',
)
_PATTERNS: Final = list_of(text(""), 'a list of packages or patterns, such as ["demo_msgs", "*/srv/*"]')
_RULES: Final = list_of(text(""), 'a list of rules, such as ["keyword-name"]', frozenset)
_RULES_OF_FILES: Final = table_of(
    _RULES, 'a table of lists of rules, such as {"vendor/*" = ["keyword-name"]}'
)


@dataclass(frozen=True, slots=True, kw_only=True)
class Config:
    """The keys of `[tool.ifgen]`, with their defaults, and the `file` that has them.

    Each key is written here and nowhere else. An option on the command line wins over its key.
    """

    file: Path | None = None
    paths: tuple[Path, ...] = key(PATHS, [])
    output: Path = key(PATH, "generated")
    include: tuple[Path, ...] = key(PATHS, [])
    exclude: tuple[str, ...] = key(_PATTERNS, [])
    with_deps: WithDeps = key(_WITH_DEPS, False)
    tests: bool = key(FLAG, True)
    templates: Path | None = key(CODE)
    filters: Path | None = key(CODE)
    outputs: Mapping[str, Output] = key(_OUTPUTS, {})
    generate: Mapping[str, Target] = key(_TARGETS, {})
    python: bool = key(FLAG, True)
    distributions: str | None = key(_DISTRIBUTIONS)
    requirements: Mapping[str, str] = key(_REQUIREMENTS, {})
    ignore: frozenset[str] = key(_RULES, [])
    per_file_ignores: Mapping[str, frozenset[str]] = key(_RULES_OF_FILES, {})
    strict: bool = key(FLAG, False)
    breaking: str = key(one_of("source", "hash", "wire"), "source")
    adapters: Path = key(PATH, "adapters")
    ros_distro: RosDistro | None = key(one_of(*get_args(RosDistro)))

    def place(self, *path: str) -> Span:
        """The place of a key in the file."""
        from ifgen.config.toml_text import find_key, read_source

        assert self.file is not None, "only a file has keys"
        return find_key(read_source(self.file), path)


def read_config(file: Path, data: bytes) -> Config | None:
    """The configuration in a pyproject.toml with these contents; None if it has none. Raises UsageError."""
    import hashlib

    # Parsing TOML takes longer than all that follows, so its result is cached.
    digest = hashlib.sha256(data).hexdigest()
    cached = (
        resources.cache_folder() / "config" / f"{hashlib.sha256(os.fsencode(file)).hexdigest()[:32]}.json"
    )
    with suppress(OSError, ValueError, LookupError, TypeError):
        note = read_json(cached)
        if note["digest"] == digest and not _mistakes(note["table"]):
            return _config(file, note["table"])
    from ifgen.config.toml_text import diagnostic, parse, read_source
    from ifgen.writing import cache

    source = read_source(file)
    tool = parse(source).get("tool")
    table = cast("dict[str, Any]", tool).get("ifgen") if isinstance(tool, dict) else None
    if found := _mistakes(table):
        raise UsageError(diagnostic(source, mistake) for mistake in found)
    cache.keep(cached, json.dumps({"digest": digest, "table": table}))
    return _config(file, table)


def _config(file: Path, table: Any) -> Config | None:
    return None if table is None else Config(file=file, **read(Config, table, file.parent))


def _mistakes(table: Any) -> list[Mistake]:
    """The mistakes in `[tool.ifgen]`: those of its keys or, if there are none, of the rules to ignore."""
    if table is None:
        return []
    if found := list(mistakes(Config, table, "tool.ifgen")):
        return found
    if wrong := list(_wrong_targets(table.get("generate", {}))):
        return wrong
    rules: dict[tuple[str, ...], Iterable[str]] = {("ignore",): table.get("ignore", ())}
    rules |= {("per_file_ignores", pattern): of for pattern, of in table.get("per_file_ignores", {}).items()}
    if not any(rules.values()):
        return []
    from ifgen.config import rulebook  # a page to parse, which few runs need

    return [
        Mistake(path, why_not[0], f"in '{path[0]}'", why_not[1], rule)
        for path, listed in rules.items()
        for rule in listed
        if (why_not := rulebook.why_not_ignored(rule))
    ]


def _wrong_targets(targets: Mapping[str, Mapping[str, Any]]) -> Iterator[Mistake]:
    for name, target in targets.items():
        if bool(target.get("use")) == bool(target.get("command")):
            found = "both are there" if target.get("use") else "neither is there"
            yield Mistake(("generate", name), f"[tool.ifgen.generate.{name}] needs 'use' or 'command'", found)
