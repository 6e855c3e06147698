"""One table of all fields of all interfaces, as CSV: a generator for ifgen in one function."""

from __future__ import annotations

import csv
from io import StringIO

from ifgen.generators import File, Generator, Option, Request, Response
from ifgen.model import Message

_HEAD = ("type", "field", "of", "unit", "default", "bytes", "comment")


def generate(request: Request) -> Response:
    """A row for each field of what is to be generated."""
    table = StringIO()
    writer = csv.writer(table, delimiter=request.options["delimiter"], lineterminator="\n")
    writer.writerow(_HEAD)
    for message in request.model.types:
        if message.generate and message.kind in request.options["kinds"]:
            writer.writerows(_rows(message))
    return Response((File("fields.csv", table.getvalue()),))


def _rows(message: Message) -> list[tuple[object, ...]]:
    size = message.wire.max_size if message.wire.fixed else ""
    return [
        (message.type_name, f.name, f.type.text, f.unit or "", f.default or "", size, f.documentation)
        for f in message.fields
    ]


GENERATOR = Generator(
    name="csv",
    version="1.0",
    description="one table of all fields, for spreadsheets",
    options=(
        Option("delimiter", "string", ",", "what stands between columns", (",", ";", "\t")),
        Option("kinds", "array", ["message", "request", "response", "goal", "result", "feedback"]),
    ),
    generate=generate,
)
