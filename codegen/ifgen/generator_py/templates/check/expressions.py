"""The types of expressions, and what is wrong in them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

import jinja2
from jinja2 import nodes
from jinja2.filters import FILTERS

from ifgen.diagnostics import Diagnostic, Label, Severity, did_you_mean
from ifgen.generator_py.templates.check import filters
from ifgen.generator_py.templates.check.frame import Frame, Macro, facts_of, path_of
from ifgen.generator_py.templates.check.types import (
    ANYTHING,
    NOTHING,
    NUMBER,
    TEXT,
    TRUTH,
    Anything,
    Either,
    Function,
    Group,
    Many,
    Plain,
    Record,
    Table,
    Type,
    attribute,
    attributes,
    either,
    element_of,
    members_of,
    named,
    of_value,
)

_LISTED = 12


_DEFINED = frozenset(("defined", "undefined"))
_DEFAULTS = frozenset(("default", "d"))


class Expressions:
    """Finds the types of expressions; `problems` are the mistakes in them, each place and message once."""

    def __init__(self, environment: jinja2.Environment) -> None:
        self.environment = environment
        self.problems: dict[tuple[str, int, str], Diagnostic] = {}

    def report(  # noqa: PLR0913 - one place where a problem gets its form
        self,
        frame: Frame,
        node: nodes.Node,
        rule: str,
        message: str,
        *,
        word: str = "",
        known: Iterable[str] = (),
        advice: str | None = None,
        warning: bool = False,
    ) -> None:
        """Note a problem at a node; `word` is the part of it to point to, `known` what it may have meant."""
        span = frame.template.span(node, word)
        advice = advice or _advice(word, sorted(known))
        severity: Severity = "warning" if warning else "error"
        found = Diagnostic(rule, message, Label(span), help=advice, severity=severity)
        self.problems.setdefault((str(span.source.path), span.start, message), found)

    def call_macro(self, macro: Macro, arguments: Sequence[Type], keywords: Mapping[str, Type]) -> None:
        """Look at what a macro does with arguments of these types."""
        raise NotImplementedError

    def call_super(self, frame: Frame) -> bool:
        """Look at the block that this one overrides; whether there is one."""
        raise NotImplementedError

    def type_of(self, node: nodes.Node, frame: Frame, *, lenient: bool = False) -> Type:
        """The type of an expression; a `lenient` look does not mind what is undefined."""
        match node:
            case nodes.Name():
                return self._name(node, frame, lenient)
            case nodes.Const(value=value) | nodes.TemplateData(data=value):
                return of_value(value)
            case nodes.Getattr():
                return self._attribute(node, node.node, str(node.attr), frame, lenient)
            case nodes.Getitem(arg=nodes.Const(value=str() as name)):
                return self._attribute(node, node.node, name, frame, lenient)
            case nodes.Getitem():
                return self._item(node, frame, lenient)
            case nodes.Filter():
                return self._filter(node, frame)
            case nodes.Test():
                self._test(node, frame)
                return TRUTH
            case nodes.Call():
                return self._call(node, frame)
            case nodes.CondExpr():
                yes, no = facts_of(node.test, frame, self)
                self.type_of(node.test, frame)
                first = self.type_of(node.expr1, frame.inside(yes), lenient=lenient)
                second = (
                    NOTHING
                    if node.expr2 is None
                    else self.type_of(node.expr2, frame.inside(no), lenient=lenient)
                )
                return either((first, second))
            case nodes.And() | nodes.Or():
                yes, no = facts_of(node.left, frame, self)
                left = self.type_of(node.left, frame)
                right = self.type_of(node.right, frame.inside(yes if isinstance(node, nodes.And) else no))
                return either((left, right))
            case _:
                return self._plain(node, frame)

    def _plain(self, node: nodes.Node, frame: Frame) -> Type:
        """Expressions whose parts are looked at for their own sake."""
        match node:
            case nodes.Tuple(items=items) | nodes.List(items=items):
                elements = tuple(self.type_of(item, frame) for item in items)
                return Group(elements) if isinstance(node, nodes.Tuple) else Many(either(elements))
            case nodes.Dict(items=items):
                keys = [self.type_of(pair.key, frame) for pair in items]
                return Table(either(keys), either([self.type_of(pair.value, frame) for pair in items]))
            case nodes.Not() | nodes.Compare():
                result: Type = TRUTH
            case nodes.Concat():
                result = TEXT
            case nodes.Add(left=left, right=right):
                both = (self.type_of(left, frame), self.type_of(right, frame))
                return both[0] if both[0] == both[1] else ANYTHING
            case _:
                result = ANYTHING
        for child in node.iter_child_nodes():
            self.type_of(child.expr if isinstance(child, nodes.Operand) else child, frame)
        return result

    def _name(self, node: nodes.Name, frame: Frame, lenient: bool) -> Type:
        name = str(node.name)
        if name in frame.facts:
            return frame.facts[name]
        if name in frame.names:
            return frame.names[name]
        if name in self.environment.globals:
            return of_value(self.environment.globals[name])
        if name == "super" and frame.block is not None:
            return ANYTHING
        if not lenient and name != "self":
            message = f"'{name}' is not defined here"
            self.report(frame, node, "unknown-name", message, word=name, known=frame.names)
        return ANYTHING

    def _attribute(self, node: nodes.Node, of: nodes.Node, name: str, frame: Frame, lenient: bool) -> Type:
        owner = self.type_of(of, frame, lenient=lenient)
        path = path_of(node)
        if path is not None and path in frame.facts:
            return frame.facts[path]
        return self.attribute_of(owner, name, node, frame, lenient=lenient)

    def attribute_of(
        self, owner: Type, name: str, node: nodes.Node, frame: Frame, *, lenient: bool = False
    ) -> Type:
        """The type of an attribute; a problem if no value of the owner's type has it, or some have not."""
        found = [(member, attribute(member, name)) for member in members_of(owner)]
        types = [type_ for _, type_ in found if type_ is not None]
        lacking = [member for member, type_ in found if type_ is None]
        if lacking and not lenient:
            rest = either(lacking)
            message, advice = f"{named(rest)} has no '{name}'", None
            if rest == NOTHING and types:
                message = f"this may be none, which has no '{name}'"
                advice = f"put it into an `{{% if {path_of(_owner(node)) or '...'} %}}`"
            # Python's own methods are no help.
            known = () if isinstance(rest, Plain | Many | Group) else attributes(rest) or ()
            self.report(
                frame, node, "unknown-attribute", message,
                word=name, known=known, advice=advice, warning=bool(types),
            )  # fmt: skip
        return either(types) if types else ANYTHING

    def _item(self, node: nodes.Getitem, frame: Frame, lenient: bool) -> Type:
        owner = self.type_of(node.node, frame, lenient=lenient)
        if isinstance(node.arg, nodes.Slice):
            self._plain(node.arg, frame)
            return Many(either(owner.elements)) if isinstance(owner, Group) else owner
        self.type_of(node.arg, frame)
        match owner, node.arg:
            case Group(elements), nodes.Const(value=int() as index) if (
                -len(elements) <= index < len(elements)
            ):
                return elements[index]
            case Group(elements), nodes.Const(value=int()):
                self.report(frame, node, "unknown-attribute", f"there are {len(elements)} elements only")
                return ANYTHING
            case Table(_, value), _:
                return value
            case ((Record() | Function()), _):
                self.report(frame, node, "unknown-attribute", f"{named(owner)} has no elements")
                return ANYTHING
            case _:
                element = None if isinstance(owner, Either) else element_of(owner)
                return ANYTHING if element is None else element

    def _filter(self, node: nodes.Filter, frame: Frame) -> Type:
        name = str(node.name)
        value = TEXT if node.node is None else self.type_of(node.node, frame, lenient=name in _DEFAULTS)
        arguments = [self.type_of(argument, frame) for argument in node.args]
        keywords = {str(k.key): self.type_of(k.value, frame) for k in node.kwargs}
        open_ended = self._stars(node, frame)
        function = self.environment.filters.get(name)
        if function is None:
            known = self.environment.filters
            self.report(frame, node, "unknown-filter", f"there is no filter '{name}'", word=name, known=known)
            return ANYTHING
        wrong = None if open_ended else filters.misfit(function, len(arguments), list(keywords), subject=True)
        if wrong:
            self.report(
                frame, node, "wrong-arguments", f"filter '{name}' does not take this: {wrong}", word=name
            )
        if name not in FILTERS:
            self._wants(filters.wanted_by(function), node, name, value, frame)
            return filters.result_of_function(function)
        if name in filters.FOR_TEXT:
            self._wants(TEXT, node, name, value, frame)
        element: Type = ANYTHING
        if name in filters.FOR_MANY:
            element = self.element_of(node, value, frame, word=name)
        chosen = self._chosen_attribute(node, name, element, frame)
        if name == "map" and chosen is not None:
            return Many(chosen)
        return filters.result_of_filter(name, value, arguments)

    def _wants(self, wanted: Type, node: nodes.Node, name: str, value: Type, frame: Frame) -> None:
        """Look at what a filter is given, if it is for values such as text and numbers."""
        members = members_of(wanted)
        is_other = isinstance(value, Record | Many | Group | Table | Function | Macro)
        is_missing = value == NOTHING and NOTHING not in members
        if (is_other or is_missing) and all(isinstance(member, Plain) for member in members):
            message = f"filter '{name}' is for {named(wanted)}, and this is {named(value)}"
            self.report(frame, node, "wrong-type", message, word=name)

    def _chosen_attribute(self, node: nodes.Filter, name: str, element: Type, frame: Frame) -> Type | None:
        """The type of the attribute that a filter gets by name, as in `|map(attribute="name")`."""
        told = [k.value for k in node.kwargs if k.key == "attribute"] if name in filters.ATTRIBUTES else []
        if not told and name in filters.ATTRIBUTE_FIRST - {"map", "unique"}:
            told = node.args[:1]
        if not told and name == "map":
            for argument in node.args[:1]:
                if isinstance(argument, nodes.Const) and argument.value not in self.environment.filters:
                    known = self.environment.filters
                    message = f"there is no filter '{argument.value}'"
                    self.report(
                        frame, argument, "unknown-filter", message, word=str(argument.value), known=known
                    )
        if not told or not isinstance(told[0], nodes.Const) or not isinstance(told[0].value, str):
            return None
        for part in told[0].value.replace(",", ".").split("."):
            if not part.isidentifier():
                return ANYTHING
            element = self.attribute_of(element, part, told[0], frame)
            if name == "sort":  # which can get several attributes
                return ANYTHING
        return element

    def _test(self, node: nodes.Test, frame: Frame) -> None:
        name = str(node.name)
        self.type_of(node.node, frame, lenient=name in _DEFINED)
        for argument in node.args:
            self.type_of(argument, frame)
        for keyword in node.kwargs:
            self.type_of(keyword.value, frame)
        function = self.environment.tests.get(name)
        if function is None:
            known = self.environment.tests
            self.report(frame, node, "unknown-test", f"there is no test '{name}'", word=name, known=known)
        elif not self._stars(node, frame):
            keywords = [str(k.key) for k in node.kwargs]
            wrong = filters.misfit(function, len(node.args), keywords, subject=True)
            if wrong:
                self.report(
                    frame, node, "wrong-arguments", f"test '{name}' does not take this: {wrong}", word=name
                )

    def _call(self, node: nodes.Call, frame: Frame) -> Type:
        arguments = [self.type_of(argument, frame) for argument in node.args]
        keywords = {str(k.key): self.type_of(k.value, frame) for k in node.kwargs}
        open_ended = self._stars(node, frame)
        if isinstance(node.node, nodes.Name) and node.node.name == "super" and "super" not in frame.names:
            if frame.block is not None and not self.call_super(frame):
                self.report(
                    frame,
                    node.node,
                    "unknown-block",
                    "super() finds no block",
                    word="super",
                )
            return TEXT
        function = self.type_of(node.node, frame)
        match function:
            case Function(result):
                return result
            case Macro() if open_ended:
                return TEXT
            case Macro():
                self._macro(node, function, arguments, keywords, frame)
                return TEXT
            case Anything() | Either():
                name = str(node.node.name) if isinstance(node.node, nodes.Name) else ""
                return Many(NUMBER) if name == "range" and "range" not in frame.names else ANYTHING
            case _:
                message = f"{named(function)} cannot be called"
                self.report(frame, node, "not-callable", message)
                return ANYTHING

    def _macro(
        self, node: nodes.Call, macro: Macro, arguments: list[Type], keywords: dict[str, Type], frame: Frame
    ) -> None:
        names = [str(argument.name) for argument in macro.node.args]
        used = {str(name.name) for name in macro.node.find_all(nodes.Name)}
        name = str(macro.node.name)
        if len(arguments) > len(names) and "varargs" not in used:
            takes = f"{len(names)} argument{'s' * (len(names) != 1)}"
            message = f"macro '{name}' takes {takes}, not {len(arguments)}"
            self.report(frame, node.node, "wrong-arguments", message, word=name)
        for keyword in keywords:
            if keyword not in names and keyword != "caller" and "kwargs" not in used:
                message = f"macro '{name}' has no argument '{keyword}'"
                self.report(frame, node, "wrong-arguments", message, word=keyword, known=names)
        self.call_macro(macro, arguments, keywords)

    def _stars(self, node: nodes.Call | nodes.Filter | nodes.Test, frame: Frame) -> bool:
        """Whether there are `*arguments` or `**keywords`."""
        stars = [star for star in (node.dyn_args, node.dyn_kwargs) if star is not None]
        for star in stars:
            self.type_of(star, frame)
        return bool(stars)

    def element_of(self, node: nodes.Node, value: Type, frame: Frame, *, word: str = "") -> Type:
        """The type of the elements in a loop over a value; a problem if it has none."""
        element = element_of(value)
        if element is None:
            self.report(
                frame, node, "not-iterable", f"{named(value)} has no elements to loop over", word=word
            )
            return ANYTHING
        return element


def _owner(node: nodes.Node) -> nodes.Node:
    return node.node if isinstance(node, nodes.Getattr) else node


def _advice(word: str, known: Sequence[str]) -> str | None:
    if hint := did_you_mean(word, known):
        return hint
    return f"known here: {', '.join(known)}" if known and len(known) <= _LISTED else None
