"""From planned files to their texts: what an earlier run left as it has to be has its text already."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping

from ifgen.config.customization import Customization
from ifgen.generator_py.artifact import Artifact, OutputFile
from ifgen.generator_py.templates.render import Templates
from ifgen.pipeline.job import PlannedPackage
from ifgen.writing.write import OutputPackage


def render(planned: Iterable[PlannedPackage], custom: Customization) -> Iterator[OutputPackage]:
    """The packages with the texts of their files. Raises InputError for a template that is wrong."""
    templates: Templates | None = None  # the user's filters are loaded only if they are needed
    for package in planned:
        templates = templates or Templates(custom)
        yield OutputPackage(
            package.name,
            _texts(package.files, templates),
            package.interfaces,
            package.source,
            _texts(package.beside, templates),
            _texts(package.once, templates),
        )


def _texts(files: Mapping[str, Artifact | OutputFile], templates: Templates) -> dict[str, str]:
    return {
        path: file.text if isinstance(file, OutputFile) else templates.render(file).text
        for path, file in files.items()
    }
