"""C99 structs of bounded size, and the tables that their codec reads: no heap, no recursion, no ROS."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Final

from ifgen.generators import File, Finding, Generator, Option, Request, Response

from ifgen_generators import c_family
from ifgen_generators.c.bounds import Bounds
from ifgen_generators.c.rows import Tables
from ifgen_generators.c.sources import Sources
from ifgen_generators.c.testee import testee
from ifgen_generators.shared import name_clashes

_HERE: Final = Path(__file__).parent


def generate(request: Request) -> Response:
    """A header and a source for each interface, and those of the codec; errors at fields without a bound."""
    bounds = Bounds(request.options["bounds"])
    types = c_family.needed(request.model)
    for message in types:
        bounds.add(message)
    if findings := (*_wrong(request), *_findings(bounds), *name_clashes(request.model, "c")):
        return Response(findings=findings)
    return Response(tuple(_files(request, Tables(types, bounds), bounds)))


def _files(request: Request, tables: Tables, bounds: Bounds) -> Iterator[File]:
    sources = Sources(request.model, bounds, tables)
    for interface in c_family.generated(request.model):
        yield File(c_family.path(interface, "h"), sources.header(interface))
        yield File(c_family.path(interface, "c"), sources.source(interface))
    header = (_HERE / "cdr.h").read_text("utf-8")
    yield File("ifgen/cdr.h", header.replace("@depth@", str(tables.depth)))
    for name in ("cdr.c", "equal.c"):
        yield File(f"ifgen/{name}", (_HERE / name).read_text("utf-8"))
    if request.options["testee"]:
        yield from (
            File(f"testee/{name}", (_HERE / name).read_text("utf-8")) for name in ("testee.h", "testee.c")
        )
        yield from (File(path, text) for path, text in testee(request.model))


def _wrong(request: Request) -> Iterator[Finding]:
    for key, bound in request.options["bounds"].items():
        if type(bound) is not int or not 1 <= bound <= c_family.MAX_COUNT:
            message = (
                f"option 'bounds' has {bound!r} for {key!r}, and a bound is a whole number from 1 to 2^31 - 1"
            )
            yield Finding(None, message)


def _findings(bounds: Bounds) -> Iterator[Finding]:
    for missing in bounds.unbounded:
        kind = "sequence" if missing.pattern == "*.sequence" else "string"
        yield Finding(
            missing.field.id,
            f"C needs a bound for this {kind}, and neither the interface nor the option 'bounds' has one",
            help=f'set bounds = {{ "{missing.key}" = 32 }} in options, or for all "{missing.pattern}" = 32',
        )
    for field in bounds.overflowing:
        yield Finding(field.id, "the default of this field is longer than its bound in the option 'bounds'")
    for key in sorted(bounds.unused):
        yield Finding(
            None,
            f"option 'bounds' has {key!r}, which is no string or sequence of these interfaces",
            help="write pkg/msg/Name.field, and pkg/msg/Name.field[] for the strings in a sequence",
        )


GENERATOR: Final = Generator(
    name="c",
    version="1.0",
    description="C99 without heap for microcontrollers, with the names of rosidl",
    options=(
        Option(
            "bounds",
            "object",
            {},
            'room for unbounded fields, such as { "std_msgs/msg/Header.frame_id" = 32 }',
        ),
        Option("testee", "boolean", False, "also write the program that `ifgen conformance` asks"),
    ),
    generate=generate,
    sources=(_HERE, Path(c_family.__file__)),
)
"""The generator, for the entry point."""
