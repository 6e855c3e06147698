"""C++17 headers for messages, services and actions, which need no ROS: a header for an interface."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Final

from ifgen.generators import File, Generator, Option, Request, Response

from ifgen_generators import c_family
from ifgen_generators.cpp.headers import Headers
from ifgen_generators.cpp.testee import testee
from ifgen_generators.shared import name_clashes

_HERE: Final = Path(__file__).parent


def generate(request: Request) -> Response:
    """The headers, and that of the codec; errors where names clash."""
    if findings := tuple(name_clashes(request.model, "cpp")):
        return Response(findings=findings)
    return Response(tuple(_files(request)))


def _files(request: Request) -> Iterator[File]:
    headers = Headers(request.model)
    for interface in c_family.generated(request.model):
        yield File(c_family.path(interface, "hpp"), headers.header(interface))
    yield File("ifgen/cdr.hpp", (_HERE / "cdr.hpp").read_text("utf-8"))
    if request.options["testee"]:
        yield File("testee/testee.hpp", (_HERE / "testee.hpp").read_text("utf-8"))
        yield from (File(path, text) for path, text in testee(request.model))


GENERATOR: Final = Generator(
    name="cpp",
    version="1.0",
    description="C++17 headers without ROS, with the names and include paths of rosidl",
    options=(Option("testee", "boolean", False, "also write the program that `ifgen conformance` asks"),),
    generate=generate,
    sources=(_HERE, Path(c_family.__file__)),
)
"""The generator, for the entry point."""
