"""Generators: the public interface for packages that bring one (docs/generators.md).

An entry point in the group `ifgen.generators` names a `Generator`, under the name that users write after
`use`. It is a set of templates, or a Python function; programs of other languages speak the JSON of
`ifgen.generators.protocol`. What we ship uses this and `ifgen.model`, and nothing else of ifgen.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Final, Literal

from ifgen.model import VERSION, Model

GROUP: Final = "ifgen.generators"
"""The group of entry points."""

FEATURES: Final[Mapping[str, str]] = {
    "services": "services",
    "actions": "actions",
    "wstring": "wide strings",
    "char": "the char of .idl files",
    "int64": "integers of 64 bits",
    "bounded-strings": "bounds of strings",
    "unbounded": "strings and sequences without a bound",
    "sequences": "sequences",
    "defaults": "default values",
    "constants": "constants",
    "empty": "messages without fields",
}
"""The features that a generator may lack, in words. An interface that needs one that it lacks is refused."""

Per = Literal["package", "interface", "node", "run"]
OptionType = Literal["boolean", "integer", "number", "string", "array", "object"]
Severity = Literal["error", "warning"]


@dataclass(frozen=True, slots=True)
class Option:
    """An option that users may set: its default says what it is without them.

    `choices` are the texts that are allowed, if it is one of a few.
    """

    name: str
    type: OptionType
    default: Any
    help: str = ""
    choices: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Output:
    """Files of a set of templates: one for each package, interface or node, or for the whole run.

    `template` is a name in the folder of the set, `path` a pattern as in `[tool.ifgen.outputs]`.
    """

    template: str
    path: str
    per: Per


@dataclass(frozen=True, slots=True)
class File:
    """A file to write: its path from the output folder, with `/`, and its text or its bytes."""

    path: str
    content: str | bytes


@dataclass(frozen=True, slots=True)
class Finding:
    """A message to the user about an element of the model, by its id; None if it is about none.

    An error stops the run, and nothing is written.
    """

    element: str | None
    message: str
    severity: Severity = "error"
    help: str | None = None


@dataclass(frozen=True, slots=True)
class Request:
    """The request to a generator: the files for those elements of `model` that have `generate`.

    `options` have a value for each option. `name` is the name of the target in the configuration.
    """

    model: Model
    options: Mapping[str, Any]
    name: str


@dataclass(frozen=True, slots=True)
class Response:
    """The files that a generator made, and its findings."""

    files: tuple[File, ...] = ()
    findings: tuple[Finding, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class Generator:
    """A generator: a set of `templates` with its `outputs`, or a function `generate`; or both.

    `model` is the version of the model that it needs. `features` are those of `FEATURES` that it has; all of
    them, if it is None. `templates` is a folder, and `filters` a Python file of filters for them. `check` may
    look for what it cannot express, before anything is made; templates get `model`, `options` and the
    variables of their output (docs/templates.md).
    """

    name: str
    version: str
    description: str = ""
    model: str = VERSION
    features: frozenset[str] | None = None
    options: tuple[Option, ...] = ()
    templates: Path | None = None
    filters: Path | None = None
    outputs: tuple[Output, ...] = ()
    generate: Callable[[Request], Response] | None = None
    check: Callable[[Request], tuple[Finding, ...]] | None = None
    sources: tuple[Path, ...] = field(default=())
    """Files and folders whose change means that everything has to be made again; its module is one anyway."""
