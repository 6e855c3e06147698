"""Walks through templates as they would be rendered, and reports what cannot work."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace

import jinja2
from jinja2 import nodes

from ifgen.diagnostics import Diagnostic, InputError
from ifgen.generator_py.templates.check.expressions import Expressions
from ifgen.generator_py.templates.check.frame import Frame, Macro, facts_of
from ifgen.generator_py.templates.check.syntax import Block, Template, definitions, idle_blocks
from ifgen.generator_py.templates.check.types import (
    ANYTHING,
    TEXT,
    Group,
    Many,
    Names,
    Record,
    Type,
    either,
    loop_over,
    named,
    of_annotation,
)

_DEEPEST = 20
# Macros and templates that call themselves with ever more complex values have no end of their own.
_MOST_VISITS = 2000

Load = Callable[[str], Template | None]
"""Gives the template of a name, or None if there is none. Raises InputError if it does not parse."""


class Checker(Expressions):
    """Checks templates; `known` are the names of all that there are.

    `given` are the names that each template has at its start, including those of loops around an include.
    """

    def __init__(self, environment: jinja2.Environment, load: Load, known: Iterable[str]) -> None:
        super().__init__(environment)
        self._load = load
        self._known = tuple(known)
        self._seen: set[object] = set()
        self._open: list[tuple[str, bool]] = []
        self._refused: list[Diagnostic] = []
        self.given: dict[str, dict[str, Type]] = {}

    def check(self, name: str, variables: Mapping[str, object]) -> None:
        """Check a template that is given variables of these types, and all that it uses."""
        template = self._loaded(name)
        if template is not None:
            names: dict[str, Type] = {key: of_annotation(type_) for key, type_ in variables.items()}
            self._template(Frame(template, names, dict(names)))

    def found(self) -> list[Diagnostic]:
        """All problems, in the order of files and lines."""
        return [
            *self._refused,
            *(problem for _, problem in sorted(self.problems.items(), key=lambda i: i[0])),
        ]

    def _loaded(self, name: str) -> Template | None:
        try:
            return self._load(name)
        except InputError as error:
            self._refused += [d for d in error.diagnostics if d not in self._refused]
            return None

    def _visited(self, place: object) -> bool:
        """Whether a place with what is known there has been looked at before; from now on it has."""
        if place in self._seen or len(self._seen) >= _MOST_VISITS:
            return True
        self._seen.add(place)
        return False

    # --- templates

    def _template(self, frame: Frame) -> None:
        """A template and those that it extends, with the names that the frame has."""
        if self._visited((frame.template, *_state(frame))) or len(self._open) > _DEEPEST:
            return
        self.given.setdefault(frame.template.name, dict(frame.names))
        self._open.append((frame.template.name, frame.sure))
        chain = self._chain(frame)
        blocks = definitions(chain)
        for template, block, known in idle_blocks(chain):
            message = f"this overrides nothing: there is no block '{block.name}'"
            here = replace(frame, template=template)
            self.report(here, block, "unknown-block", message, word=str(block.name), known=known)
        for template in chain:
            inner = replace(frame, template=template, blocks=blocks, toplevel=True)
            self._macros_ahead(inner)
            self.body(template.tree.body, inner, extends=template is not chain[-1])
            self._all_macros(inner)
        self._open.pop()

    def _chain(self, frame: Frame) -> list[Template]:
        """A template, the one that it extends, and so on."""
        chain = [frame.template]
        while True:
            extends = next(iter(chain[-1].tree.find_all(nodes.Extends)), None)
            if extends is None:
                return chain
            here = replace(frame, template=chain[-1])
            parents = self._referenced(extends.template, here)
            if not parents:
                return chain
            if parents[0] in chain:
                message = f"'{parents[0].name}' extends itself" + (
                    " by way of others" if len(chain) > 1 else ""
                )
                advice = f'ifgen\'s own is "ifgen/{parents[0].name}"' if parents[0] is chain[-1] else None
                self.report(here, extends, "template-cycle", message, word="extends", advice=advice)
                return chain
            chain.append(parents[0])

    def _referenced(self, node: nodes.Expr, frame: Frame, *, ignore: bool = False) -> list[Template]:
        """The templates that an expression names with literals."""
        match node:
            case nodes.Const(value=str() as text):
                name = "/".join(part for part in text.split("/") if part not in {"", "."})
                if name not in self._known:
                    if not ignore:
                        message = f"there is no template '{name}'"
                        self.report(frame, node, "unknown-template", message, word=text, known=self._known)
                    return []
                template = self._loaded(name)
                return [] if template is None else [template]
            case nodes.List(items=items) | nodes.Tuple(items=items):
                # jinja2 takes the first one that there is.
                found = [name for item in items for name in self._referenced(item, frame, ignore=True)]
                return found[:1]
            case nodes.CondExpr(expr1=first, expr2=second):
                self.type_of(node.test, frame)
                parts = [part for part in (first, second) if part is not None]
                return [name for part in parts for name in self._referenced(part, frame, ignore=ignore)]
            case _:
                self.type_of(node, frame)
                return []

    # --- statements

    def body(self, statements: Iterable[nodes.Node], frame: Frame, *, extends: bool = False) -> None:
        """Statements one after the other; text outside of blocks is not rendered where a template extends."""
        for statement in statements:
            if not (extends and isinstance(statement, nodes.Block)):
                self._statement(statement, frame)

    def _statement(self, node: nodes.Node, frame: Frame) -> None:
        match node:
            case nodes.Output(nodes=parts):
                for part in parts:
                    self._printed(part, frame)
            case nodes.If():
                self._if(node, frame)
            case nodes.For():
                self._for(node, frame)
            case nodes.Block():
                self._block(node, frame)
            case nodes.Include():
                for template in self._referenced(node.template, frame, ignore=bool(node.ignore_missing)):
                    self._include(node, template, frame)
            case nodes.Import() | nodes.FromImport():
                self._import(node, frame)
            case nodes.Assign(target=target, node=value):
                self._assign(target, self.type_of(value, frame), frame)
            case nodes.AssignBlock(target=target, filter=filter_, body=body):
                self.body(body, frame.inside())
                if filter_ is not None:
                    self.type_of(filter_, frame)
                self._assign(target, TEXT, frame)
            case nodes.With(targets=targets, values=values, body=body):
                types = [self.type_of(value, frame) for value in values]
                inner = replace(frame.inside(), sure=frame.sure)
                for target, type_ in zip(targets, types, strict=True):
                    self._assign(target, type_, inner)
                self.body(body, inner)
            case nodes.Macro(name=name):
                frame.assign(str(name), Macro(node, frame))
            case nodes.CallBlock(call=call, args=args, body=body):
                inner = frame.inside()
                inner.names.update((str(argument.name), ANYTHING) for argument in args)
                self.body(body, inner)
                self.type_of(call, frame)
            case nodes.FilterBlock(filter=filter_, body=body):
                self.body(body, frame.inside())
                self.type_of(filter_, frame)
            case nodes.Extends():
                pass
            case nodes.ExprStmt(node=expression):
                self.type_of(expression, frame)
            case _:
                for child in node.iter_child_nodes():
                    if isinstance(child, nodes.Expr):
                        self.type_of(child, frame)
                    else:
                        self._statement(child, frame)

    def _printed(self, node: nodes.Expr, frame: Frame) -> None:
        type_ = self.type_of(node, frame)
        if isinstance(type_, Record | Many | Group) and not isinstance(node, nodes.TemplateData):
            message = f"{named(type_)} is printed as Python shows it"
            self.report(frame, node, "printed-value", message, advice="print its parts", warning=True)

    def _if(self, node: nodes.If, frame: Frame) -> None:
        branches: list[Frame] = []
        known: dict[str, Type] = {}
        for branch in (node, *node.elif_):
            place = frame.inside(known)
            self.type_of(branch.test, place)
            yes, no = facts_of(branch.test, place, self)
            branches.append(replace(place.inside(yes), toplevel=frame.toplevel))
            self.body(branch.body, branches[-1])
            known |= no
        branches.append(replace(frame.inside(known), toplevel=frame.toplevel))
        self.body(node.else_, branches[-1])
        for name in {name for branch in branches for name in branch.names}:
            types = [branch.names[name] for branch in branches if name in branch.names]
            if any(type_ != frame.names.get(name) for type_ in types):
                frame.assign(
                    name, either(types) if not any(isinstance(t, Macro) for t in types) else types[0]
                )

    def _for(self, node: nodes.For, frame: Frame) -> None:
        element = self.element_of(node.iter, self.type_of(node.iter, frame), frame)
        inner = frame.inside()
        self._assign(node.target, element, inner)
        if node.test is not None:
            self.type_of(node.test, inner)
            yes, _ = facts_of(node.test, inner, self)
            inner = inner.inside(yes)
        inner.names["loop"] = loop_over(element)
        if node.recursive:
            inner.names["loop"] = ANYTHING
        self.body(node.body, inner)
        self.body(node.else_, frame.inside())

    def _assign(self, target: nodes.Node, type_: Type, frame: Frame) -> None:
        match target:
            case nodes.Name(name=name):
                frame.assign(str(name), type_)
            case nodes.Tuple(items=items):
                if isinstance(type_, Group) and len(type_.elements) != len(items):
                    message = f"{len(items)} names for {len(type_.elements)} values"
                    self.report(frame, target, "wrong-type", message)
                elements = type_.elements if isinstance(type_, Group) else ()
                for index, item in enumerate(items):
                    self._assign(item, elements[index] if index < len(elements) else ANYTHING, frame)
            case nodes.NSRef(name=name):
                if name not in frame.names:
                    self.report(
                        frame, target, "unknown-name", f"'{name}' is not defined here", word=str(name)
                    )
            case _:
                pass

    # --- blocks, includes, imports, macros

    def _block(self, node: nodes.Block, frame: Frame) -> None:
        defined = frame.blocks.get(str(node.name)) or [(frame.template, node)]
        names = frame.names if node.scoped else frame.context
        place = replace(frame, names=dict(names), toplevel=False)
        self._definition(str(node.name), defined, 0, place)

    def _definition(self, name: str, defined: Sequence[Block], index: int, frame: Frame) -> None:
        template, block = defined[index]
        if not self._visited((template, block, *_state(frame))):
            here = replace(frame, template=template, block=(name, index), context=dict(frame.names))
            self.body(block.body, here)

    def call_super(self, frame: Frame) -> bool:
        """Look at the block that this one overrides; whether there is one."""
        name, index = frame.block or ("", 0)
        defined = frame.blocks.get(name, [])
        if index + 1 >= len(defined):
            return False
        self._definition(name, defined, index + 1, frame)
        return True

    def _include(self, node: nodes.Include, template: Template, frame: Frame) -> None:
        names = dict(frame.names) if node.with_context else {}
        opened = [name for name, _ in self._open]
        if template.name in opened:
            since = self._open[opened.index(template.name) + 1 :]
            if frame.sure and all(sure for _, sure in since):
                message = f"'{template.name}' includes itself without end"
                self.report(frame, node, "template-cycle", message, word="include")
                return
        self._template(Frame(template, names, dict(names), facts=frame.facts, sure=frame.sure))

    def _import(self, node: nodes.Import | nodes.FromImport, frame: Frame) -> None:
        exported: dict[str, Type] | None = None
        templates = self._referenced(node.template, frame)
        opened = [name for name, _ in self._open]
        for template in templates[:1]:
            names = dict(frame.names) if node.with_context else {}
            inner = Frame(template, dict(names), dict(names), sure=False)
            self._macros_ahead(inner)
            if template.name not in opened:
                self._open.append((template.name, False))
                self.body(template.tree.body, inner)
                self._all_macros(inner)
                self._open.pop()
            exported = {name: type_ for name, type_ in inner.context.items() if name not in names}
        if isinstance(node, nodes.Import):
            known = Names(templates[0].name, tuple(exported.items())) if exported is not None else ANYTHING
            frame.assign(str(node.target), known)
            return
        for wanted in node.names:
            name, alias = wanted if isinstance(wanted, tuple) else (wanted, wanted)
            if exported is not None and name not in exported:
                message = f"'{templates[0].name}' has no '{name}'"
                self.report(frame, node, "unknown-name", message, word=name, known=exported)
            frame.assign(alias, (exported or {}).get(name, ANYTHING))

    def _macros_ahead(self, frame: Frame) -> None:
        """Macros can call those that stand below them."""
        for statement in frame.template.tree.body:
            if isinstance(statement, nodes.Macro):
                frame.assign(str(statement.name), Macro(statement, frame))

    def _all_macros(self, frame: Frame) -> None:
        """Every macro of a template once, whatever its arguments may be."""
        for macro in frame.template.tree.find_all(nodes.Macro):
            self.call_macro(Macro(macro, frame), (), {})

    def call_macro(self, macro: Macro, arguments: Sequence[Type], keywords: Mapping[str, Type]) -> None:
        """Look at what a macro does with arguments of these types."""
        names = [str(argument.name) for argument in macro.node.args]
        given = {**dict.fromkeys(names, ANYTHING), **dict(zip(names, arguments, strict=False)), **keywords}
        if self._visited((macro.node, frozenset(given.items()))) or len(self._open) > _DEEPEST:
            return
        self._open.append(("", False))
        for default in macro.node.defaults:
            self.type_of(default, macro.frame)
        frame = replace(macro.frame.inside(), facts={}, block=None)
        special = dict.fromkeys(("caller", "varargs", "kwargs"), ANYTHING)
        frame.names.update({**special, **given})
        self.body(macro.node.body, frame)
        self._open.pop()


def _state(frame: Frame) -> tuple[object, object]:
    return frozenset(frame.names.items()), frozenset(frame.facts.items())
