"""Values for what users can customise: templates, filters, outputs, tests, and the target ROS 2."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Final, Literal, get_args

from ifgen.config.keys import CODE, FLAG, PATH, Kind, key, list_of, one_of, required, table_of, text
from ifgen.diagnostics import Label, Span

Per = Literal["package", "interface", "node", "run"]

_ONLY: Final = list_of(text(""), 'a list of patterns, such as ["demo_msgs", "*/srv/*"]')
_COMMAND: Final = list_of(text(""), 'a program and its arguments, such as ["node", "generate.mjs"]')
_FORMATTERS: Final = table_of(
    Kind(_COMMAND.expected, lambda value: _COMMAND.wrong(value) if value else [value], _COMMAND.read),
    'a table of programs, such as {"*.ts" = ["prettier", "--stdin-filepath", "{path}"]}',
)
_OPTIONS: Final = Kind("a table", lambda value: () if isinstance(value, dict) else (value,))
_SECONDS: Final = Kind(
    "a number of seconds above 0",
    lambda value: () if type(value) in {int, float} and value > 0 else (value,),
)


@dataclass(frozen=True, slots=True)
class Output:
    """Files to generate beside ifgen's own: one for each package, interface or node, or one in a run.

    `template` is a name in the user's folder of templates. `path` is a pattern, from the output folder, whose
    fields stand in braces: `{package}/docs/{interface:snake}.md`. `only` has glob patterns of what to make it
    for: `demo_msgs`, `*/srv/*`, `robot/nodl/camera_*`; everything, if it is empty.
    """

    name: str
    template: str = required(text("the name of a template in quotes"))
    path: str = required(text('a pattern in quotes, such as "{package}/{interface:snake}.md"'))
    per: Per = required(one_of(*get_args(Per)))
    only: tuple[str, ...] = key(_ONLY, [])
    span: Span | None = field(default=None, compare=False, repr=False)
    spans: Mapping[str, Span] = field(default_factory=dict[str, Span], compare=False, repr=False)

    def label(self, key: str) -> Label | None:
        """The place of a key in the configuration; of the table, if that does not have it."""
        span = self.spans.get(key, self.span)
        return None if span is None else Label(span)


@dataclass(frozen=True, slots=True)
class Target:
    """A target of `[tool.ifgen.generate]`: what a generator writes into the folder `out`.

    `use` is the name of an installed generator, `command` a program that is one; it has `time_limit` seconds.
    `only` has patterns as an `Output` has. With `with_deps` all that these interfaces need is generated too.
    What the generator cannot express is refused, or left out if `unsupported` is "skip". `templates` is a
    folder whose templates win over those of the generator. `format` has a program for patterns of paths,
    which reads a text and writes it as it should be. `span` is the place of the table.
    """

    name: str
    out: Path = required(PATH)
    use: str | None = key(text("the name of a generator in quotes"))
    command: tuple[str, ...] = key(_COMMAND, [])
    options: Mapping[str, Any] = key(_OPTIONS, {})
    only: tuple[str, ...] = key(_ONLY, [])
    with_deps: bool = key(FLAG, False)
    unsupported: Literal["error", "skip"] = key(one_of("error", "skip"), "error")
    templates: Path | None = key(CODE)
    format: Mapping[str, tuple[str, ...]] = key(_FORMATTERS, {})
    time_limit: float = key(_SECONDS, 60)
    base: Path = field(default=Path(), compare=False, repr=False)
    span: Span | None = field(default=None, compare=False, repr=False)

    def place(self, *path: str) -> Span | None:
        """The place of a key of the table in the configuration, or of the innermost table around it."""
        if self.span is None:
            return None
        from ifgen.config.toml_text import find_key  # only errors need it

        return find_key(self.span.source, ("generate", self.name, *path))


@dataclass(frozen=True, slots=True)
class Distributions:
    """How pip names generated packages: a pattern of names, such as `acme-{package}`."""

    names: str
    span: Span | None = field(default=None, compare=False, repr=False)

    def name_of(self, package: str) -> str:
        """The name of a package of ours as pip writes it."""
        return self.names.replace("{package}", package.replace("_", "-"))


@dataclass(frozen=True, slots=True)
class Customization:
    """Templates that replace ours or make outputs, the Python file with filters, and the outputs.

    In a `partial` run, which generates only some packages of the project, outputs may match nothing, and
    outputs per run stay as they are. Without `tests` no tests are generated. `behind` is a second folder of
    templates; those in `templates` win over it. With `distributions`, pip can install generated packages.
    `requirements` says what pip installs for other packages that these need; nothing, where it is empty.
    The original of a template in `behind` has its path after `behind_name`, as one of ifgen's has it after
    `ifgen`. `ros_distro` is the target ROS 2, if it is known. `targets` are the generators to run, beside the
    Python packages or, if `python` is False, in place of them.
    """

    templates: Path | None = None
    filters: Path | None = None
    outputs: tuple[Output, ...] = ()
    partial: bool = False
    tests: bool = True
    behind: Path | None = None
    behind_name: str | None = None
    distributions: Distributions | None = None
    requirements: Mapping[str, str] = field(default_factory=dict[str, str])
    ros_distro: str | None = None
    targets: tuple[Target, ...] = ()
    python: bool = True

    @property
    def folders(self) -> tuple[Path, ...]:
        """The folders of templates; those in a later one win."""
        return tuple(folder for folder in (self.behind, self.templates) if folder is not None)
