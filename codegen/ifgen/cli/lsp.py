"""The command `ifgen lsp`."""

from __future__ import annotations

import logging
import os
import sys

import click

from ifgen.diagnostics import Diagnostic, UsageError

# Late imports: the server needs the extra `lsp`, and `ifgen --help` loads this module.


@click.command(epilog="Example: `ifgen lsp --help`; an editor starts `ifgen lsp`")
def lsp() -> int:
    """Serve an editor in the Language Server Protocol.

    The editor starts this program and talks to it by standard input and output. It answers with the findings
    of `ifgen check` while you type, and with definitions, references, completion, new names and formatting
    for .msg, .srv, .action, .idl and NoDL files. It needs the extra `lsp`: pip install 'ifgen-ros[lsp]'.
    """
    try:
        from ifgen.language_server.server import make_server
    except ModuleNotFoundError as error:
        if error.name not in {"pygls", "lsprotocol"}:
            raise
        raise UsageError(
            [
                Diagnostic(
                    "missing-extra",
                    "the language server needs pygls, which is not installed",
                    help="pip install 'ifgen-ros[lsp]'",
                )
            ]
        ) from None
    # A request that cannot be met has its answer: what pygls would log besides is no fault of ours.
    logging.getLogger("pygls").addFilter(_is_fault)
    logging.getLogger("pygls.protocol.json_rpc").addFilter(_is_fault)
    # The server closes the streams that it is given, and ours are to be flushed at the end.
    with os.fdopen(os.dup(sys.stdin.fileno()), "rb") as stdin:
        make_server().start_io(stdin, os.fdopen(os.dup(sys.stdout.fileno()), "wb"))
    return 0


def _is_fault(record: logging.LogRecord) -> bool:
    """Whether a record is about something else than a request that was refused."""
    from pygls.exceptions import JsonRpcInvalidParams

    return not (record.exc_info and isinstance(record.exc_info[1], JsonRpcInvalidParams))
