"""From the tree of an .idl file to a message, a service or an action."""

from __future__ import annotations

import keyword
from collections.abc import Callable, Iterable

from ifgen.definition import derive, names, rules
from ifgen.definition.explain import bad_value, duplicate
from ifgen.definition.interfaces import Constant, Field, Folder, Interface, Message, Scalar
from ifgen.definition.literals import BadValue
from ifgen.definition.omg_idl import mistakes
from ifgen.definition.omg_idl.annotations import read_annotations
from ifgen.definition.omg_idl.contents import SUFFIXES, Contents, Placed, check_rest, contents_of, parts_of
from ifgen.definition.omg_idl.types import Types
from ifgen.definition.omg_idl.values import constant_value, default_value
from ifgen.definition.problems import FileProblems
from ifgen.definition.types import BasicType, FieldType
from ifgen.diagnostics import Diagnostic, Label, Source, Span
from ifgen.idl.explain import too_many_definitions
from ifgen.idl.omg_parser import parse_idl
from ifgen.idl.omg_tree import (
    ConstantDclNode,
    DeclaratorNode,
    IncludeNode,
    MemberNode,
    StructNode,
    TypeNode,
    ValueNode,
)
from ifgen.idl.parser import MAX_DEFINITIONS


def interface(
    source: Source,
    package: str,
    folder: Folder,
    name: str,
    problems: FileProblems,
    is_there: Callable[[str], bool] | None = None,
) -> Interface:
    """Parse an .idl file and say what it means; what is wrong with it goes to `problems`.

    With problems the result holds everything that was understood. `is_there` tests whether a file that it
    includes exists.
    """
    tree = parse_idl(source)
    contents = contents_of(tree)
    problems.extend(tree.problems, 0)
    if (problem := _too_many(contents, source)) is not None:
        problems.extend([problem], 0)
        contents = Contents()
        structs: list[Placed[StructNode] | None] = [None] * len(SUFFIXES[folder])
    else:
        # Beside wrong syntax nothing is said of what the rest means: it may follow from what was left out.
        problems = FileProblems(source) if tree.problems else problems
        structs = parts_of(contents, source, package, folder, name, problems)
        check_rest(contents, source, problems)
    _check_includes(contents.includes, source, problems, is_there)
    builder = _Builder(source, package, folder, contents, problems)
    parts = [
        builder.message(placed, name + suffix)
        for placed, suffix in zip(structs, SUFFIXES[folder], strict=True)
    ]
    builder.check_other_constants(contents)
    match folder:
        case "msg":
            return parts[0]
        case "srv":
            return derive.service(package, folder, name, parts[0], parts[1])
        case "action":
            return derive.action(package, name, parts[0], parts[1], parts[2])


def _too_many(contents: Contents, source: Source) -> Diagnostic | None:
    starts = contents.starts()
    if len(starts) <= MAX_DEFINITIONS:
        return None
    start = starts[MAX_DEFINITIONS]
    return too_many_definitions(Span(source, start, start + 1), MAX_DEFINITIONS)


def _check_includes(
    includes: Iterable[IncludeNode],
    source: Source,
    problems: FileProblems,
    is_there: Callable[[str], bool] | None,
) -> None:
    for node in includes:
        if is_there is not None and not is_there(node.path):
            problems.warning(_missing_include, node, source)


def _missing_include(node: IncludeNode, source: Source) -> Diagnostic:
    return Diagnostic(
        "missing-include",
        f"there is no file '{node.path}' to include",
        Label(
            Span(source, node.start, node.end), "rosidl does not look for it, and finds the types without it"
        ),
        help="write `package/msg/Name.idl`, or name the folder that it is in with -I DIR",
        severity="warning",
    )


class _Builder:
    """Builds the messages of one file."""

    def __init__(
        self, source: Source, package: str, folder: Folder, contents: Contents, problems: FileProblems
    ) -> None:
        self._source = source
        self._package = package
        self._folder: Folder = folder
        self._contents = contents
        self._problems = problems
        self._types = Types(source, contents.typedefs, contents.enums, package, problems)
        self._checked: set[int] = set()
        self._has_tags = "[@" in source.text or "@range" in source.text

    def message(self, placed: Placed[StructNode] | None, name: str) -> Message:
        """The message that a struct defines, with its constants; an empty one where there is no struct."""
        start = Span(self._source, 0, 0)
        if placed is None:
            return Message(self._package, self._folder, name, (), span=start, source=self._source)
        node = placed.node
        if not node.members:
            self._problems.error(mistakes.empty_struct, self._source, node)
        fields: dict[str, Field] = {}
        for member in node.members:
            self._member(member, fields)
        constants: dict[str, Constant] = {}
        for constant in self._contents.constants_of(node.name):
            self._constant(constant.node, constants)
        if fields.keys() == {names.PLACEHOLDER} and fields[names.PLACEHOLDER].type == BasicType("uint8"):
            fields.clear()
        for field in fields.values():
            if field.span is not None and rules.is_troublesome(field.name):
                self._problems.warning(rules.field_name, field.name, field.span)
        if self._has_tags:
            from ifgen.definition.meaning.check import check_tags  # late: few files have tags

            check_tags(fields.values(), constants, self._problems)
        check_python_names(fields.values(), constants.values(), self._problems)
        said = read_annotations(node.annotations, self._source, self._problems)
        return Message(
            self._package,
            self._folder,
            name,
            tuple(fields.values()),
            tuple(constants.values()),
            said.documentation,
            Span(self._source, node.start, node.start + len(node.name)),
            self._source,
            said.others,
        )

    def check_other_constants(self, contents: Contents) -> None:
        """Read the constants that belong to no struct too: rosidl_parser fails where one of them is wrong."""
        for placed in contents.constants:
            if placed.node.start not in self._checked:
                self._constant(placed.node, {})

    def _member(self, node: MemberNode, fields: dict[str, Field]) -> None:
        if len(node.declarators) > 1 and any(declarator.sizes for declarator in node.declarators[:-1]):
            self._problems.error(_mixed_declarators, node, self._source)
            return
        said = read_annotations(node.annotations, self._source, self._problems)
        type_span = Span(self._source, node.type.start, node.type.end)
        for declarator in node.declarators:
            name = declarator.name
            span = Span(self._source, declarator.start, declarator.start + len(name))
            type_ = self._types.member(node.type, declarator)
            if type_ is None:
                return
            if name in fields:
                self._problems.error(duplicate, "field", name, span, fields[name].span)
            else:
                value = (
                    None
                    if said.default is None
                    else self._default(said.default, type_, node.type, declarator)
                )
                fields[name] = Field(
                    name, type_, value, said.documentation, said.unit, span, type_span, said.others
                )

    def _default(
        self, node: ValueNode, type_: FieldType, written: TypeNode, declarator: DeclaratorNode
    ) -> Scalar | tuple[Scalar, ...] | None:
        span = Span(self._source, node.start, node.end)
        try:
            value = default_value(node, type_)
        except BadValue as error:
            self._problems.error(bad_value, error, self._type_text(written, declarator), span)
            return None
        self._check_number(node, type_, value)
        return value

    def _constant(self, node: ConstantDclNode, constants: dict[str, Constant]) -> None:
        self._checked.add(node.start)
        said = read_annotations(node.annotations, self._source, self._problems)
        span = Span(self._source, node.start, node.start + len(node.name))
        type_ = self._types.constant(node.type)
        if node.name in constants:
            self._problems.error(duplicate, "constant", node.name, span, constants[node.name].span)
            return
        if type_ is None:
            return
        value_span = Span(self._source, node.value.start, node.value.end)
        try:
            value = constant_value(node.value, type_)
        except BadValue as error:
            self._problems.error(bad_value, error, self._type_text(node.type), value_span)
            return
        self._check_number(node.value, type_, value, is_constant=True)
        constants[node.name] = Constant(
            node.name, type_, value, said.documentation, span, said.unit, said.others
        )

    def _check_number(
        self,
        node: ValueNode,
        type_: FieldType,
        value: Scalar | tuple[Scalar, ...],
        *,
        is_constant: bool = False,
    ) -> None:
        span = Span(self._source, node.start, node.end)
        rules.check_float32(type_, value, span, self._problems, "double")
        if (
            node.kind == "integer"
            and isinstance(value, float)
            and not (is_constant and type_ == BasicType("double"))
        ):
            self._problems.warning(mistakes.integer_for_float, span, type_ == BasicType("float"))

    def _type_text(self, node: TypeNode, declarator: DeclaratorNode | None = None) -> str:
        text = " ".join(self._source.text[node.start : node.end].split())
        sizes = declarator.sizes if declarator else ()
        return text + "".join(f"[{self._source.text[size.start : size.end]}]" for size in sizes)


def _mixed_declarators(node: MemberNode, source: Source) -> Diagnostic:
    array = next(declarator for declarator in node.declarators if declarator.sizes)
    last = node.declarators[-1]
    return Diagnostic(
        "idl-unsupported",
        f"'{last.name}' follows an array in one member",
        Label(Span(source, last.start, last.start + len(last.name)), "rosidl of Jazzy makes it an array too"),
        (Label(Span(source, array.start, array.start + len(array.name)), "the array"),),
        "write a member for each name: newer versions of rosidl read this differently",
    )


def check_python_names(
    fields: Iterable[Field], constants: Iterable[Constant], problems: FileProblems
) -> None:
    """Report names that are taken: by the class itself, by another field, or by a default value."""
    taken: dict[str, Span | None] = {"SLOT_TYPES": None}
    fields = tuple(fields)
    with_default = {field.name.upper() for field in fields if field.default_value is not None}
    for field in fields:
        needed = [names.attribute_name(field)]
        if field.name.upper() in with_default:  # the class looks for a default by that name
            needed.append(names.default_name(field))
        for name in needed:
            if name in taken:
                problems.error(_taken, "field", field.name, name, field.span, taken[name])
            taken.setdefault(name, field.span)
    taken["get_fields_and_field_types"] = None
    for constant in constants:
        if keyword.iskeyword(constant.name):
            problems.error(_keyword, constant)
        elif constant.name in taken:
            problems.error(
                _taken, "constant", constant.name, constant.name, constant.span, taken[constant.name]
            )


def _keyword(constant: Constant) -> Diagnostic:
    assert constant.span is not None
    message = f"no constant of a Python class can be called '{constant.name}'"
    return Diagnostic("keyword-name", message, Label(constant.span), help="rename the constant")


def _taken(what: str, shown: str, name: str, span: Span | None, other: Span | None) -> Diagnostic:
    assert span is not None
    attribute = f"`{name}`" if name == shown else f"`{name}` of '{shown}'"
    return Diagnostic(
        "name-clash",
        f"the {what} {attribute} has the name of something else in its Python class",
        Label(span),
        (Label(other, "this has it"),) if other else (),
        "rename one of them" if other else f"rename the {what}",
    )
