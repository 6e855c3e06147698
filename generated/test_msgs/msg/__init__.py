"""Messages of test_msgs.

Classes are loaded when they are first used.
"""

from __future__ import annotations

from ifgen_runtime.lazy import lazy_exports

TYPE_CHECKING = False  # typing itself takes longer to import than this package
if TYPE_CHECKING:
    from test_msgs.msg._arrays import Arrays as Arrays
    from test_msgs.msg._basic_types import BasicTypes as BasicTypes
    from test_msgs.msg._bounded_plain_sequences import BoundedPlainSequences as BoundedPlainSequences
    from test_msgs.msg._bounded_sequences import BoundedSequences as BoundedSequences
    from test_msgs.msg._builtins import Builtins as Builtins
    from test_msgs.msg._constants import Constants as Constants
    from test_msgs.msg._defaults import Defaults as Defaults
    from test_msgs.msg._empty import Empty as Empty
    from test_msgs.msg._multi_nested import MultiNested as MultiNested
    from test_msgs.msg._nested import Nested as Nested
    from test_msgs.msg._strings import Strings as Strings
    from test_msgs.msg._unbounded_sequences import UnboundedSequences as UnboundedSequences
    from test_msgs.msg._w_strings import WStrings as WStrings

__all__ = [
    "Arrays",
    "BasicTypes",
    "BoundedPlainSequences",
    "BoundedSequences",
    "Builtins",
    "Constants",
    "Defaults",
    "Empty",
    "MultiNested",
    "Nested",
    "Strings",
    "UnboundedSequences",
    "WStrings",
]

__getattr__, __dir__ = lazy_exports(
    __name__,
    {
        "Arrays": "_arrays",
        "BasicTypes": "_basic_types",
        "BoundedPlainSequences": "_bounded_plain_sequences",
        "BoundedSequences": "_bounded_sequences",
        "Builtins": "_builtins",
        "Constants": "_constants",
        "Defaults": "_defaults",
        "Empty": "_empty",
        "MultiNested": "_multi_nested",
        "Nested": "_nested",
        "Strings": "_strings",
        "UnboundedSequences": "_unbounded_sequences",
        "WStrings": "_w_strings",
    },
)
