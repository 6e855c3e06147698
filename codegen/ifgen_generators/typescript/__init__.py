"""TypeScript from interfaces: ES modules that read and write CDR, without dependencies."""

from __future__ import annotations

from pathlib import Path

from ifgen.generators import File, Generator, Option, Request, Response


def generate(request: Request) -> Response:
    """The modules of the interfaces that are asked for and of what they need; errors where names clash."""
    from ifgen_generators.shared import name_clashes  # `generators list` does without
    from ifgen_generators.typescript.generator import MEMBERS, Options, files  # the same

    if findings := tuple(name_clashes(request.model, "typescript", MEMBERS)):
        return Response(findings=findings)
    made = files(request.model, Options(**request.options))
    return Response(tuple(File(path, text) for path, text in made.items()))


GENERATOR = Generator(
    name="typescript",
    version="1.0",
    description="ES modules that read and write CDR, without dependencies",
    options=(
        Option("int64", "string", "bigint", "the type of 64-bit integers", ("bigint", "number")),
        Option(
            "arrays", "string", "typed", "arrays of numbers: typed arrays, or number[]", ("typed", "plain")
        ),
        Option("extension", "string", ".js", "the end of the names in imports", (".js", ".ts")),
        Option("definitions", "boolean", True, "whether `definition` has the text of each interface"),
        Option("testee", "boolean", False, "also write testee.ts, for `ifgen conformance`"),
    ),
    generate=generate,
    sources=(Path(__file__).parent,),
)
