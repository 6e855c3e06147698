"""Names that other languages keep for themselves, and the rule for them: `_` is appended."""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache
from types import MappingProxyType
from typing import Final

_C: Final = """
auto break case char const continue default do double else enum extern float for goto if inline int long
register restrict return short signed sizeof static struct switch typedef union unsigned void volatile while
_Alignas _Alignof _Atomic _Bool _Complex _Generic _Imaginary _Noreturn _Static_assert _Thread_local
alignas alignof bool constexpr false nullptr static_assert thread_local true typeof typeof_unqual
"""

_WORDS: Final = {
    "c": _C,
    "cpp": f"""
        {_C} and and_eq asm bitand bitor catch char16_t char32_t char8_t class co_await co_return co_yield
        compl concept const_cast consteval constinit decltype delete dynamic_cast explicit export friend
        mutable namespace new noexcept not not_eq operator or or_eq private protected public
        reinterpret_cast requires static_cast template this throw try typeid typename using virtual
        wchar_t xor xor_eq
    """,
    "csharp": """
        abstract as base bool break byte case catch char checked class const continue decimal default
        delegate do double else enum event explicit extern false finally fixed float for foreach goto if
        implicit in int interface internal is lock long namespace new null object operator out override
        params private protected public readonly ref return sbyte sealed short sizeof stackalloc static
        string struct switch this throw true try typeof uint ulong unchecked unsafe ushort using virtual
        void volatile while
    """,
    "go": """
        break case chan const continue default defer else fallthrough for func go goto if import interface
        map package range return select struct switch type var
    """,
    "java": """
        abstract assert boolean break byte case catch char class const continue default do double else
        enum extends false final finally float for goto if implements import instanceof int interface long
        native new null package private protected public return short static strictfp super switch
        synchronized this throw throws transient true try void volatile while _
    """,
    "javascript": """
        arguments await break case catch class const continue debugger default delete do else enum eval
        export extends false finally for function if implements import in instanceof interface let new
        null package private protected public return static super switch this throw true try typeof var
        void while with yield constructor prototype __proto__
    """,
    "kotlin": """
        as break class continue do else false for fun if in interface is null object package return super
        this throw true try typealias typeof val var when while
    """,
    # Also what a generated class needs for itself.
    "python": """
        False None True and as assert async await break class continue def del elif else except finally
        for from global if import in is lambda nonlocal not or pass raise return try while with yield self
        check_fields get_fields_and_field_types
    """,
    "rust": """
        Self abstract as async await become box break const continue crate do dyn else enum extern false
        final fn for gen if impl in let loop macro match mod move mut override priv pub ref return self
        static struct super trait true try type typeof unsafe unsized use virtual where while yield
    """,
    "swift": """
        Any Protocol Self Type as associatedtype break case catch class continue default defer deinit do
        else enum extension fallthrough false fileprivate for func guard if import in init inout internal
        is let nil open operator precedencegroup private protocol public repeat rethrows return self
        static struct subscript super switch throw throws true try typealias var where while
    """,
}

RESERVED: Final = {
    **{language: frozenset(words.split()) for language, words in _WORDS.items()},
    # Fields are properties there, which may have any name but those that every object has.
    "typescript": frozenset({"constructor", "prototype", "__proto__"}),
}
"""The words that each language keeps for itself."""

LANGUAGES: Final = tuple(sorted(RESERVED))
"""The languages that `names` of the model's elements has names for."""


def safe_name(name: str, language: str) -> str:
    """The name in a language: with `_` after it if that keeps it for itself. Raises KeyError."""
    return f"{name}_" if name in RESERVED[language] else name


@lru_cache(maxsize=8192)
def safe_names(name: str) -> Mapping[str, str]:
    """The name in each language. Elements of one name share the mapping, so it cannot be changed."""
    return MappingProxyType({language: safe_name(name, language) for language in LANGUAGES})
