"""pydantic v2 models of messages, with bounds, defaults, descriptions and conversion (docs/generators.md)."""

from pathlib import Path
from typing import Final

from ifgen.generators import Generator, Option, Output

_HERE: Final = Path(__file__).parent

GENERATOR: Final = Generator(
    name="pydantic",
    version="1.0",
    description="pydantic v2 models, a module for each interface",
    options=(
        Option("package", "string", "message_models", "the package that `out` is, for its imports"),
        Option("convert", "boolean", True, "methods from and to our message classes, which they import"),
    ),
    templates=_HERE / "templates",
    filters=_HERE / "filters.py",
    outputs=(
        Output("model.py.j2", "{package}/{folder}/{interface:snake}.py", "interface"),
        Output("index.py.j2", "{package}/__init__.py", "package"),
    ),
)
"""The generator, for the entry point."""
