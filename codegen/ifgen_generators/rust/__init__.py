"""Rust from interfaces: a crate that reads and writes CDR, without dependencies and unsafe code."""

from __future__ import annotations

from pathlib import Path

from ifgen.generators import File, Generator, Option, Request, Response


def generate(request: Request) -> Response:
    """The crate with the interfaces that are asked for and those that they need; errors where names clash."""
    from ifgen_generators.rust.generator import Options, clashes, files  # `generators list` does without

    options = Options(**request.options)
    if findings := tuple(clashes(request.model, options)):
        return Response(findings=findings)
    made = files(request.model, options)
    return Response(tuple(File(path, text) for path, text in made.items()))


GENERATOR = Generator(
    name="rust",
    version="1.0",
    description="a crate that reads and writes CDR, with std only and without unsafe code",
    options=(
        Option("crate", "string", "interfaces", "the name in Cargo.toml; empty: modules of a crate of yours"),
        Option("root", "string", "crate", "the module that has the packages"),
        Option("views", "boolean", True, "whether messages have views, which borrow from the payload"),
        Option("testee", "boolean", False, "also write src/bin/testee.rs, for `ifgen conformance`"),
    ),
    generate=generate,
    sources=(Path(__file__).parent,),
)
