"""`ifgen nodl`: documents of nodes, and what they say of nodes that run."""

from __future__ import annotations

import click

from ifgen_tools.nodl import document_verbs, node_verbs


@click.group()
def nodl() -> None:
    """Work with node descriptions in NoDL.

    `ifgen check` looks for mistakes in them, and `ifgen generate` makes packages from them.
    """


for _verb in (*document_verbs.VERBS, *node_verbs.VERBS):
    nodl.add_command(_verb)
