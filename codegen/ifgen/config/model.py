"""`[tool.ifgen]` in pyproject.toml, the only configuration: what it may say, and what is wrong with it."""

from __future__ import annotations

from pathlib import Path as AnyPath
from typing import Annotated, Literal, TypeAlias, cast

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, ValidationError, field_validator

from ifgen.config.customization import Per
from ifgen.config.explain import diagnostic, parse, read_source, unknown_rules
from ifgen.config.ros_distro import RosDistro
from ifgen.diagnostics import UsageError

# Empty, or as PEP 508 begins. pip reads the rest.
Requirement: TypeAlias = Annotated[
    str, Field(pattern=r"^([A-Za-z0-9]([A-Za-z0-9._-]*[A-Za-z0-9])? *([\[<>=!~;@(].*)?)?$")
]


def _without_nul(path: AnyPath) -> AnyPath:
    if "\0" in str(path):
        raise ValueError
    return path


Path: TypeAlias = Annotated[AnyPath, AfterValidator(_without_nul)]
"""The path of a file. The system takes a NUL for its end, or fails."""


class OutputConfig(BaseModel):
    """The keys of `[tool.ifgen.outputs.NAME]`: `customization.Output` as it is written."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    template: str = Field(description="your template, by its path in the folder of templates")
    path: str = Field(description="the pattern of the path to write to, in the output folder")
    per: Per = Field(description="one file for each package, interface, node or run")
    only: tuple[str, ...] = Field(default=(), description="patterns of packages, interfaces and nodes")


class Config(BaseModel):
    """The keys of `[tool.ifgen]`. Paths are relative to its file, and absolute after reading.

    An option on the command line wins over its key here.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    paths: tuple[Path, ...] = Field(default=(), description="what to generate: PATH...")
    output: Path = Field(default=AnyPath("generated"), description="where to: -o")
    include: tuple[Path, ...] = Field(default=(), description="where dependencies are: -I")
    exclude: tuple[str, ...] = Field(
        default=(), description="patterns of packages, interfaces and nodes to leave out: --exclude"
    )
    with_deps: bool | Literal["own"] = Field(
        default=False, description="generate the dependencies too, or your own ones: --with-deps"
    )
    tests: bool = Field(default=True, strict=True, description="generate tests: --tests, --no-tests")
    templates: Path | None = Field(default=None, description="your templates: --templates")
    filters: Path | None = Field(default=None, description="a Python file with filters for templates")
    outputs: dict[str, OutputConfig] = Field(default={}, description="your own files to generate")
    distributions: str | None = Field(
        default=None,
        pattern=r"^([A-Za-z0-9][A-Za-z0-9._-]*)?\{package\}([A-Za-z0-9._-]*[A-Za-z0-9])?$",
        description="names for pip, which can then install generated packages",
    )
    requirements: dict[str, Requirement] = Field(
        default={}, description="what pip installs for packages that are generated elsewhere"
    )
    ignore: tuple[str, ...] = Field(default=(), description="rules whose warnings are not reported")
    per_file_ignores: dict[str, tuple[str, ...]] = Field(
        default={}, description="the same for files, by patterns of their paths"
    )
    strict: bool = Field(default=False, strict=True, description="warnings are errors: --strict")
    breaking: Literal["source", "hash", "wire"] = Field(
        default="source", description="what no change may break: --category"
    )
    adapters: Path = Field(
        default=AnyPath("adapters"), description="where adapters are: --output of `ifgen adapt`"
    )
    ros_distro: RosDistro | None = Field(default=None, description="the ROS 2 that the interfaces are for")

    @field_validator("with_deps", mode="plain")
    @classmethod
    def _one_of_three(cls, value: object) -> object:
        # A union of the types would have something to say for each of them.
        if isinstance(value, bool) or value == "own":
            return value
        raise ValueError


def read(path: AnyPath) -> Config | None:
    """The configuration in a pyproject.toml; None if it has no `[tool.ifgen]`. Raises UsageError."""
    source = read_source(path)
    tool = parse(source).get("tool")
    table: object = cast("dict[str, object]", tool).get("ifgen") if isinstance(tool, dict) else None
    if table is None:
        return None
    try:
        config = Config.model_validate(table)
    except ValidationError as error:
        keys = (Config.model_fields, OutputConfig.model_fields)
        raise UsageError(diagnostic(source, dict(e), *keys) for e in error.errors()) from None
    if problems := list(unknown_rules(source, config.ignore, config.per_file_ignores)):
        raise UsageError(problems)
    base = path.parent
    return config.model_copy(
        update={
            "paths": tuple(base / p for p in config.paths),
            "output": base / config.output,
            "adapters": base / config.adapters,
            "include": tuple(base / p for p in config.include),
            "templates": None if config.templates is None else base / config.templates,
            "filters": None if config.filters is None else base / config.filters,
        }
    )
