"""A reference of interfaces and nodes in Markdown: pages that link to each other (docs/generators.md)."""

from pathlib import Path
from typing import Final

from ifgen.generators import Generator, Option, Output

_HERE: Final = Path(__file__).parent

GENERATOR: Final = Generator(
    name="markdown",
    version="1.0",
    description="a reference in Markdown: an index, and a page for each package and node",
    options=(
        Option("title", "string", "Reference", "the title of the index"),
        Option("source", "boolean", False, "whether the text of each definition is shown"),
    ),
    templates=_HERE / "templates",
    filters=_HERE / "filters.py",
    outputs=(
        Output("index.md.j2", "README.md", "run"),
        Output("package.md.j2", "{package}.md", "package"),
        Output("node.md.j2", "nodes/{package}.{node}.md", "node"),
    ),
)
"""The generator, for the entry point."""
