"""The verdict on one document, as `ros2 nodl validate` gives it: what only ifgen asks for is a warning.

ifgen needs more to generate code, such as interfaces that exist, and gives errors for it in `ifgen check`.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final

from ifgen.diagnostics import Diagnostic, Label, Span
from ifgen.nodl.load import Loaded, load_document
from ifgen.reading.search_path import SearchPath

OURS: Final = frozenset(
    {
        *("unknown-package", "unknown-type", "wrong-interface-kind", "two-types"),
        *(
            "unfit-validator",
            "mixed-bounds",
            "empty-bounds",
            "wrong-default",
            "rejected-default",
            "missing-function",
        ),
        *("duplicate-timer", "unknown-publisher", "unknown-parameter", "invalid-option", "validator-module"),
        *("unfit-argument", "duplicate-validator", "unusable-name", "same-endpoint", "too-large-number"),
        *("invalid-node-name", "two-bases", "invalid-codegen"),
    }
)
"""Rules that NoDL does not have. docs/nodl.md explains them."""

# What ifgen reads all the same.
_ONLY_THEIRS: Final = frozenset({"number-as-text"})


@dataclass(frozen=True, slots=True)
class Verdict:
    """A document, None where it cannot be read, and what is wrong with it."""

    loaded: Loaded | None
    errors: tuple[Diagnostic, ...]
    warnings: tuple[Diagnostic, ...]


def verdict(path: Path, search: SearchPath, *, follow: bool = True, strict: bool = False) -> Verdict:
    """The mistakes in a document and in those that it includes.

    Includes are only looked at if they are to be followed, and what ifgen asks for beyond NoDL gives errors
    only if it is to be `strict`.
    """
    loaded, found = load_document(path, search)
    if loaded is not None:
        found += _foreign_types(loaded)
    if not follow:
        found = [each for each in found if not _is_about_others(each, path)]
    free = _free_spans(loaded)
    errors = tuple(
        each for each in found if _is_error(each, strict=strict) and (strict or not _is_in(each, free))
    )
    return Verdict(loaded, errors, tuple(_as_warnings(each for each in found if each not in errors)))


def _foreign_types(loaded: Loaded) -> Iterator[Diagnostic]:
    """Types that only .idl files can define: NoDL allows no underscore in the name of a type."""
    for endpoint in loaded.whole.endpoints:
        if "_" in endpoint.type_name.rpartition("/")[2] and endpoint.span is not None:
            message = f"NoDL does not allow the underscore in `{endpoint.type_name}`"
            yield Diagnostic("invalid-type", message, Label(endpoint.span), help="rename the interface")


def _free_spans(loaded: Loaded | None) -> list[Span]:
    """The parts of documents that NoDL does not look at: `codegen.ifgen`."""
    return [each.options.span for each in loaded.documents if each.options] if loaded else []


def _is_in(diagnostic: Diagnostic, spans: Iterable[Span]) -> bool:
    place = diagnostic.primary.span if diagnostic.primary else None
    return place is not None and any(
        place.source is span.source and span.start <= place.start and place.end <= span.end for span in spans
    )


def _is_error(diagnostic: Diagnostic, *, strict: bool) -> bool:
    if diagnostic.rule in _ONLY_THEIRS:
        return True
    return diagnostic.severity == "error" and (strict or diagnostic.rule not in OURS)


def _as_warnings(found: Iterable[Diagnostic]) -> Iterable[Diagnostic]:
    return (replace(each, severity="warning") for each in found)


def _is_about_others(diagnostic: Diagnostic, path: Path) -> bool:
    """Whether it takes other documents to see this mistake."""
    labels = [*([diagnostic.primary] if diagnostic.primary else ()), *diagnostic.secondary]
    elsewhere = any(label.span.source.path.absolute() != path.absolute() for label in labels)
    return elsewhere or diagnostic.rule in {"unknown-include", "included-twice"}
