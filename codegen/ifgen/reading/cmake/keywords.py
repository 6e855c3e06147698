"""The sorting of arguments by keywords, as in `cmake_parse_arguments`."""

from __future__ import annotations

from collections.abc import Collection, Iterable


def parsed(
    words: Iterable[str], options: Collection[str], single: Collection[str], several: Collection[str]
) -> dict[str, list[str]]:
    """The words after each keyword that is there; those that belong to none are under the empty keyword.

    An option that is there has an empty list.
    """
    found: dict[str, list[str]] = {"": []}
    current = ""
    for word in words:
        if word in options:
            found[word] = []
            current = ""
        elif word in single or word in several:
            found.setdefault(word, [])
            current = word
        else:
            found[current].append(word)
            if current in single:
                current = ""
    return found
