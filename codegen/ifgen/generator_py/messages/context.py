"""The contexts of templates: one frozen dataclass for each file, whose strings are finished Python text.

A template only puts them in their places. Names of classes, attributes and files are as they appear in
Python; docstrings and literals come with their quotes, and their later lines with their indentation.

Enumerations follow a rule: an integer field owns the constants of its own type whose names begin with the
field's name in capitals and an underscore: `int8 STATUS_ABORTED=6` belongs to `int8 status`. If two fields
fit, the longer name wins. A field whose comment says `[@enum MODE OTHER]` owns those that begin with `MODE_`
and `OTHER_` instead, and two fields may say so of the same constants. At least two constants make an
enumeration. Members drop the common part (`ABORTED`) if the rest is a name.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass

from ifgen.definition.interfaces import Constant, Field, Message
from ifgen.definition.meaning.reading import meaning_of, named_constants
from ifgen.definition.names import attribute_name
from ifgen.definition.types import ValueType, element_of
from ifgen.generator_py.codec.text import CodecText
from ifgen.generator_py.messages.fields import PythonField
from ifgen.generator_py.names import enum_name
from ifgen.generator_py.text import docstring


def enums(message: Message, spelling: Callable[[str], str] = str) -> tuple[EnumText, ...]:
    """The enumerations of a message, in the order of the fields; `spelling` spells names of Python."""
    found = list(_enums(message, spelling))
    if not found:
        return ()
    # `a_1` and `a1` would have the same name: neither gets it. In an .idl file a field or a constant may have
    # it.
    names = Counter(enum.name for enum in found)
    names.update(attribute_name(field) for field in message.fields)
    names.update(constant.name for constant in message.constants)
    return tuple(enum for enum in found if names[enum.name] == 1)


def values(message: Message) -> Iterator[tuple[Field, tuple[Constant, ...]]]:
    """The fields that own constants, two or more, and these."""
    if not message.constants:
        return
    fields = {(_prefix(field), element_of(field.type)): field for field in reversed(message.fields)}
    owned: dict[str, list[Constant]] = {}
    for constant in message.constants:
        owner = _owner(constant, fields)
        if owner is not None:
            owned.setdefault(owner.name, []).append(constant)
    for field in message.fields:
        constants = _tagged(field, message) or owned.get(field.name, ())
        if len(constants) > 1:
            yield field, tuple(constants)


def _tagged(field: Field, message: Message) -> tuple[Constant, ...]:
    """The constants that `[@enum NAME]` names, of the type of the field."""
    constants = named_constants(field, message) if _has_tag(field) else ()
    return constants if all(each.type == element_of(field.type) for each in constants) else ()


def _has_tag(field: Field) -> bool:
    return "@enum" in field.documentation or (field.unit is not None and "@enum" in field.unit)


def _enums(message: Message, spelling: Callable[[str], str]) -> Iterator[EnumText]:
    for field, constants in values(message):
        prefixes = _prefixes(field)
        names = " and ".join(f"`{prefix}...`" for prefix in prefixes)
        text = f"The values of `{field.name}`, as an enumeration of the constants {names}."
        yield EnumText(
            name=enum_name(field),
            base=spelling("IntEnum"),
            view=spelling("enum_view"),
            members=tuple(_members(constants, prefixes)),
            docstring=docstring(text, indent=12),
        )


def _owner(constant: Constant, fields: Mapping[tuple[str, ValueType], Field]) -> Field | None:
    """The field with the longest prefix that the constant has; `fields` has them by prefix and type."""
    if not isinstance(constant.value, int) or isinstance(constant.value, bool):
        return None
    end = len(constant.name)
    while (end := constant.name.rfind("_", 0, end)) >= 0:
        field = fields.get((constant.name[: end + 1], constant.type))
        if field is not None:
            return field
    return None


def _prefix(field: Field) -> str:
    return f"{field.name.upper()}_"


def _prefixes(field: Field) -> tuple[str, ...]:
    """The prefixes of the constants that a field owns, of which its members keep none."""
    named = meaning_of(field).enum if _has_tag(field) else ()
    return tuple(f"{name}_" for name in named) or (_prefix(field),)


def _members(constants: Sequence[Constant], prefixes: Sequence[str]) -> Iterator[tuple[str, str]]:
    """The name and the value of each member; with several prefixes two may have one short name."""
    short = [_short(constant.name, prefixes) for constant in constants]
    for constant, name in zip(constants, short, strict=True):
        yield constant.name if short.count(name) > 1 else name, repr(constant.value)


def _short(name: str, prefixes: Sequence[str]) -> str:
    prefix = next((each for each in prefixes if name.startswith(each)), "")
    short = name.removeprefix(prefix)
    return short if short.isidentifier() else name


@dataclass(frozen=True, slots=True)
class ConstantText:
    """A constant, or the declared default of a field (`X__DEFAULT`)."""

    name: str
    annotation: str
    value: str
    docstring: str


@dataclass(frozen=True, slots=True)
class EnumText:
    """The constants that a field can hold; `members` are (name, value).

    Type checkers see a class derived from `base`; at run time `view` makes it when it is first used.
    """

    name: str
    base: str
    view: str
    members: tuple[tuple[str, str], ...]
    docstring: str


@dataclass(frozen=True, slots=True)
class ViewsText:
    """The class of messages with views, as type checkers see it: its name, and the fields that differ.

    `alias` is the statement in the message class that makes it an attribute, and `method` is a method there
    that returns it.
    """

    name: str
    alias: str
    method: str
    fields: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class FieldText:
    """A field: its name in the definition, its attribute, its private name, and what it is in Python.

    `annotation` is that of `python` with the field's meaning: `Annotated[float, meaning.Unit("m")]`. Where a
    property converts, `getter` is its head, and `failed` what its setter does with what it cannot convert;
    else both are empty.
    """

    name: str
    attribute: str
    private: str
    annotation: str
    docstring: str
    getter: str
    failed: str
    python: PythonField


@dataclass(frozen=True, slots=True)
class ClassLines:
    """The parts that every message class of a module shares, in that module's spelling of Python's names.

    `metaclass` and `base` are what the two classes are derived from, `texts` annotates dictionaries of
    strings. `parameters` are the constructor's last ones, and `checked` is what it does where it checks.
    `repr`, `equality`, `default` and `deepcopy` are heads of methods; `untyped` is the statement that calls
    `self` a `message` of any type, and `new` the function that makes an empty object of a class.
    """

    metaclass: str
    base: str
    texts: str
    parameters: tuple[str, ...]
    checked: str
    repr: str
    equality: str
    default: str
    deepcopy: str
    untyped: str
    new: str


@dataclass(frozen=True, slots=True)
class MessageClass:
    """A message class.

    `slots` and `field_types` are the literals of `__slots__` and `_fields_and_field_types`. `renamed` are
    (name in the definition, attribute) where the two differ. `lower_constants` is the literal of the names of
    constants that are not in capitals, as only those of .idl files can be; empty where there are none.
    `is_long` is true if it has so many fields that Python takes long to compile an f-string for each;
    `shown` is then its repr, else the beginning of that. `converts` is true if some fields convert their
    values; `failed` is the constructor's statement if one cannot. `lines` are those of all messages.
    `views` is None if the message holds no sequences of numbers.
    """

    name: str
    type_name: str
    type_hash: str
    docstring: str
    lines: ClassLines
    is_long: bool
    shown: str
    slots: str
    field_types: str
    fields: tuple[FieldText, ...]
    converts: bool
    failed: str
    renamed: tuple[tuple[str, str], ...]
    constants: tuple[ConstantText, ...]
    lower_constants: str
    defaults: tuple[ConstantText, ...]
    enums: tuple[EnumText, ...]
    views: ViewsText | None
    codec: CodecText


@dataclass(frozen=True, slots=True)
class ServiceClass:
    """A service class and the names of its parts' classes, each of which is an `alias`."""

    metaclass: str
    base: str
    alias: str
    name: str
    type_name: str
    type_hash: str
    docstring: str
    request: str
    response: str
    event: str


@dataclass(frozen=True, slots=True)
class ActionClass:
    """An action class and the names of the classes that it holds, each of which is an `alias`."""

    metaclass: str
    base: str
    alias: str
    name: str
    type_name: str
    type_hash: str
    docstring: str
    goal: str
    result: str
    feedback: str
    send_goal: str
    get_result: str
    feedback_message: str
    cancel_goal: str
    goal_status_array: str


@dataclass(frozen=True, slots=True)
class InterfaceModule:
    """The module of one interface, `pkg/msg/_name.py`, with its classes in the order of their definitions.

    `imports` are the imports at run time, `typing_imports` those that only type checkers need,
    `lazy_imports` replace those of them that are used at run time, and `codec_imports` are those that only
    the codecs need. `checks` is the call that returns whether constructors check. `nested_functions` make and
    copy the messages in fields. `source` is the definition as a literal; `encoding` is `idl` if it is in OMG
    IDL, else empty. `mark` is the end of the names of Python and `ifgen_runtime` in finished strings. It is
    empty unless a class, field or constant of the module has such a name. Only a user's template that spells
    such a name itself needs it.
    """

    title: str
    type_name: str
    type_hash: str
    imports: tuple[str, ...]
    typing_imports: tuple[str, ...]
    lazy_imports: tuple[str, ...]
    codec_imports: tuple[str, ...]
    checks: str
    nested_functions: tuple[str, ...]
    mark: str
    messages: tuple[MessageClass, ...]
    services: tuple[ServiceClass, ...]
    action: ActionClass | None
    source: str
    encoding: str


@dataclass(frozen=True, slots=True)
class FolderModule:
    """`pkg/msg/__init__.py`, which loads its classes when they are first used.

    `modules` are (class, module that defines it) by module, `typing_imports` the statements that tell type
    checkers the same, and `exports` the classes sorted by name.
    """

    title: str
    modules: tuple[tuple[str, str], ...]
    typing_imports: tuple[str, ...]
    exports: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class ProjectFile:
    """`pyproject.toml` of a package that pip can install; strings are TOML's, but for the title.

    `license` and `author` may be empty. `requirements` are of the package, `ros` is of its extra.
    `scripts` are (node, function), and `shared` are (path in the package, path in the environment).
    """

    title: str
    name: str
    version: str
    description: str
    license: str
    author: str
    requirements: tuple[str, ...]
    ros: str
    package: str
    scripts: tuple[tuple[str, str], ...]
    shared: tuple[tuple[str, str], ...]


@dataclass(frozen=True, slots=True)
class PackageModule:
    """`pkg/__init__.py`; `ensured` are the literals of the packages that the runtime brings where need be."""

    title: str
    ensured: tuple[str, ...] = ()
