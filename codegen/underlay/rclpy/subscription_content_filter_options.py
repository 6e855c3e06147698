"""The filter of a subscription: which messages it wants, by their contents."""

from __future__ import annotations

from typing import NamedTuple


class ContentFilterOptions(NamedTuple):
    """An expression in the SQL subset of DDS, and the texts that its `%0` to `%99` stand for."""

    filter_expression: str
    expression_parameters: list[str]
