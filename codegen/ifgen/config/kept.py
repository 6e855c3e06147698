"""The contents of `[tool.ifgen]`, cached because pydantic takes longer than most commands."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ifgen import resources
from ifgen.config.customization import Distributions, Output
from ifgen.diagnostics import Diagnostic, Label, UsageError
from ifgen.reading.storage import read_json

if TYPE_CHECKING:
    from ifgen.reading.search_path import WithDeps

# Late imports: what a run that finds its configuration kept can do without, pydantic above all.


@dataclass(frozen=True, slots=True)
class Configuration:
    """The contents of the pyproject.toml `file`, with the names of `model.Config`."""

    file: Path
    paths: tuple[Path, ...]
    output: Path
    include: tuple[Path, ...]
    exclude: tuple[str, ...]
    with_deps: WithDeps
    tests: bool
    templates: Path | None
    filters: Path | None
    ignore: frozenset[str]
    per_file_ignores: Mapping[str, frozenset[str]]
    strict: bool
    breaking: str
    adapters: Path
    ros_distro: str | None
    _outputs: Mapping[str, Mapping[str, Any]]
    _distributions: str | None
    requirements: Mapping[str, str]

    @staticmethod
    def of(file: Path, said: Mapping[str, Any]) -> Configuration:
        """From the result of `model.Config.model_dump`, also after a round trip through JSON."""
        templates, filters = said["templates"], said["filters"]
        return Configuration(
            file,
            paths=tuple(map(Path, said["paths"])),
            output=Path(said["output"]),
            include=tuple(map(Path, said["include"])),
            exclude=tuple(said["exclude"]),
            with_deps=said["with_deps"],
            tests=bool(said["tests"]),
            templates=Path(templates) if templates else None,
            filters=Path(filters) if filters else None,
            ignore=frozenset(said["ignore"]),
            per_file_ignores={pattern: frozenset(r) for pattern, r in said["per_file_ignores"].items()},
            strict=bool(said["strict"]),
            breaking=said["breaking"],
            adapters=Path(said["adapters"]),
            ros_distro=said["ros_distro"],
            _outputs=dict(said["outputs"]),
            _distributions=said["distributions"],
            requirements=dict(said["requirements"]),
        )

    def existing(self, key: str, paths: tuple[Path, ...]) -> tuple[Path, ...]:
        """The paths of a key. Raises UsageError if one does not exist."""
        missing = [path for path in paths if not path.exists()]
        if missing:
            from ifgen.config.explain import find_key, read_source

            label = Label(find_key(read_source(self.file), (key,)))
            message = f"'{key}' in [tool.ifgen] names {{}}, which does not exist"
            help = "`ifgen new interface demo_msgs/msg/Name` makes it" if key == "paths" else None
            raise UsageError(
                Diagnostic("configuration", message.format(p), label, help=help) for p in missing
            )
        return paths

    def distributions(self) -> Distributions | None:
        """The settings for packages that pip installs, with their place in the file."""
        if self._distributions is None:
            return None
        from ifgen.config.explain import find_key, read_source

        place = find_key(read_source(self.file), ("distributions",))
        return Distributions(self._distributions, place)

    def outputs(self) -> tuple[Output, ...]:
        """The outputs that are asked for, with their places in the file."""
        if not self._outputs:
            return ()
        from ifgen.config.explain import find_key, read_source

        source = read_source(self.file)
        return tuple(
            Output(
                name,
                o["template"],
                o["path"],
                o["per"],
                tuple(o["only"]),
                find_key(source, ("outputs", name)),
            )
            for name, o in self._outputs.items()
        )


def read(file: Path, data: bytes) -> Configuration | None:
    """The configuration in a pyproject.toml with these contents; None if it has none. Raises UsageError."""
    # Everything that determines the result besides the contents, because a checkout changes without its
    # version.
    decides = Path(__file__).with_name("model.py").read_bytes()
    key = hashlib.sha256(data + decides + resources.rules_page().read_bytes()).hexdigest()
    name = hashlib.sha256(str(file).encode(errors="surrogateescape")).hexdigest()[:32]
    kept = resources.cache_folder() / "config" / f"{name}.json"
    with suppress(OSError, ValueError, LookupError, TypeError, AttributeError):
        note = read_json(kept)
        if note["key"] == key:
            return Configuration.of(file, note["said"]) if note["said"] is not None else None
    from ifgen.config import model
    from ifgen.writing import cache

    found = model.read(file)
    said = None if found is None else found.model_dump()
    cache.keep(kept, json.dumps({"key": key, "said": said}, default=str))
    return None if said is None else Configuration.of(file, said)
