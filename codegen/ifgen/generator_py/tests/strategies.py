"""Values for tests, as text: Hypothesis strategies of fields, and parameters that keep or break rules."""

from __future__ import annotations

import math
from array import array
from collections.abc import Callable, Iterable, Iterator
from itertools import cycle, islice

from ifgen.definition.interfaces import Constant, Field, Message, Registry
from ifgen.definition.literals import INTEGER_RANGES
from ifgen.definition.meaning.reading import is_closed, meaning_of
from ifgen.definition.meaning.values import Meaning, Range
from ifgen.definition.names import attribute_name
from ifgen.definition.types import (
    Array,
    BasicType,
    BoundedSequence,
    BoundedString,
    BoundedWString,
    FieldType,
    NamespacedType,
    UnboundedSequence,
    UnboundedString,
    UnboundedWString,
    ValueType,
    element_of,
)
from ifgen.generator_py.imports import LINE_LENGTH, natural
from ifgen.generator_py.messages import context
from ifgen.generator_py.names import interface_name
from ifgen.nodl import validators
from ifgen.nodl.model import Parameter, ParameterValue, ScalarValue, Validator

_Rule = Callable[[ParameterValue], bool]
_MOST_ACCEPTED = 6
_LONGEST = 1000
_ELEMENT_RULES = {"element_bounds", "lower_element_bounds", "upper_element_bounds", "subset_of"}
_SIZE_RULES = {"fixed_size", "size_gt", "size_lt"}
_HALVES = {
    "bounds": ("gt_eq", "lt_eq"),
    "element_bounds": ("lower_element_bounds", "upper_element_bounds"),
}
_INT64 = range(-(2**63), 2**63)


def accepted(parameter: Parameter) -> list[ParameterValue]:
    """Values that keep all rules, the default first; where functions judge too, the most likely one alone."""
    rules = _rules(parameter)
    keeping = (value for value in _candidates(parameter) if all(rule(value) for rule in rules))
    is_judged = any(map(validators.is_custom, parameter.validators))
    return list(islice(dict.fromkeys(keeping), 1 if is_judged else _MOST_ACCEPTED))


def refused(parameter: Parameter) -> list[ParameterValue]:
    """For each rule a value that breaks it, and others as few as can be."""
    rules = _rules(parameter)
    tried = [(value, [not rule(value) for rule in rules]) for value in _candidates(parameter)]
    found: list[ParameterValue] = []
    for index in range(len(rules)):
        breaking = [(sum(broken), value) for value, broken in tried if broken[index]]
        if breaking:
            found.append(min(breaking, key=lambda pair: pair[0])[1])
    return list(dict.fromkeys(found))


def _rules(parameter: Parameter) -> list[_Rule]:
    size = parameter.type.fixed_size
    rules: list[_Rule] = [_passes(half) for validator in parameter.validators for half in _halves(validator)]
    if size is not None:
        rules.append(lambda value: len(validators.elements(value)) <= size)
    return rules


def _halves(validator: Validator) -> tuple[Validator, ...]:
    """Both sides of a validator that has two: a value outside is to be tried on each."""
    if validator.name not in _HALVES:
        return (validator,)
    return tuple(
        Validator(name, (limit,))
        for name, limit in zip(_HALVES[validator.name], validator.arguments, strict=True)
    )


def _passes(validator: Validator) -> _Rule:
    return lambda value: validators.passes(value, validator)


def _candidates(parameter: Parameter) -> Iterator[ParameterValue]:
    """Values of the type, around everything that its rules name."""
    yield from () if parameter.default is None else (parameter.default,)
    type_ = parameter.type
    if not type_.array:
        yield from _texts(parameter) if type_.base == "string" else _scalars(parameter)
        return
    element_rules = [_passes(v) for v in parameter.validators if v.name in _ELEMENT_RULES]
    scalars = list(dict.fromkeys(_scalars(parameter)))
    good = [scalar for scalar in scalars if all(rule(_array(parameter, [scalar])) for rule in element_rules)]
    good = good or scalars
    for size in _sizes(parameter):
        yield _array(parameter, islice(cycle(good), size))
        if size > 1:
            yield _array(parameter, [good[0]] * size)
        if size:
            rest = list(islice(cycle(good), size - 1))
            yield from (_array(parameter, [*rest, scalar]) for scalar in scalars)


def _texts(parameter: Parameter) -> Iterator[str]:
    for validator in parameter.validators:
        if validator.name == "one_of":
            yield from map(str, validator.arguments)
    yield from ("x" * size for size in _sizes(parameter))


def _scalars(parameter: Parameter) -> Iterator[ScalarValue]:
    """Scalars around the arguments of validators: on a limit, on either side, and between two of them."""
    arguments = [
        argument
        for validator in parameter.validators
        if validator.name not in _SIZE_RULES
        for argument in validator.arguments
    ]
    if isinstance(parameter.default, tuple | bytes):
        yield from parameter.default
    match parameter.type.base:
        case "bool":
            yield from (True, False)
        case "string":
            yield from map(str, arguments)
            yield from ("a", "b", "c", "d")
        case "double":
            numbers = [number for number in arguments if isinstance(number, int | float)] or [1.0]
            yield from map(float, numbers)
            yield round((float(min(numbers)) + float(max(numbers))) / 2, 9)
            for number in numbers:
                distance = max(abs(number) / 50, 0.001)
                yield from (round(number - distance, 9), round(number + distance, 9))
        case base:
            limits = range(256) if base == "byte" else _INT64
            whole = [int(number) for number in arguments if isinstance(number, int)] or [1]
            around = [*whole, *(number + step for number in whole for step in (-1, 1))]
            yield from (number for number in [*around, 2, 3, 5, 8] if number in limits)


def _sizes(parameter: Parameter) -> list[int]:
    named = [v.arguments[0] for v in parameter.validators if v.name in _SIZE_RULES]
    named += [] if parameter.type.fixed_size is None else [parameter.type.fixed_size]
    if isinstance(parameter.default, tuple | bytes | str):
        named.append(len(parameter.default))
    around = [size + step for size in named if isinstance(size, int) for step in (0, -1, 1)]
    return [size for size in dict.fromkeys([*around, 1, 0, 2, 3]) if 0 <= size <= _LONGEST]


def _array(parameter: Parameter, elements: Iterable[ScalarValue]) -> ParameterValue:
    values = tuple(elements)
    return bytes(map(int, values)) if parameter.type.base == "byte" else values


# Values are drawn from these, by IDL type. NaN is left out, because it equals nothing; it has its own test.
_VALUES = {
    "boolean": ("BOOLEANS", "st.booleans()"),
    "octet": ("OCTETS", "st.binary(min_size=1, max_size=1)"),
    "char": ("ASCII", 'st.characters(codec="ascii")'),
    **{
        name: (f"{name.upper()}S", f"st.integers({low}, {high})")
        for name, (low, high) in INTEGER_RANGES.items()
        if name != "octet"
    },
    "float": ("FLOAT32S", "st.floats(allow_nan=False, width=32)"),
    "double": ("FLOAT64S", "st.floats(allow_nan=False)"),
}
# A string holds neither NUL nor half a surrogate pair. A real ROS takes U+FEFF at the beginning of a wide one
# for a byte order mark and counts its bound in UTF-16 code units, so wide ones stay in the basic plane.
# A few characters of each kind: one to four bytes in UTF-8, combining, from right to left, not printable.
_BASIC = r"aZ09 _/~\"'\\\n\t\x7fäßłЖ中\u0301\u05d0\ufffd"
_CHARACTERS = ("CHARACTERS", f'"{_BASIC}\\ufeff🤖\\U0010ffff"')
_WIDE_CHARACTERS = ("WIDE_CHARACTERS", f'"{_BASIC}"')
# Whole strings and sequences of at most the given number of elements are drawn; longer ones would take too
# long.
_DRAWN_AT_BOUND = 1000
# A collection of messages with more values than this has one element.
_HEAVY = 20


class Strategies:
    """The strategies of one test module: asking for a message's adds those that it needs before it."""

    def __init__(self, registry: Registry) -> None:
        self._registry = registry
        self._values: dict[str, str] = {}
        self._messages: dict[str, tuple[str, str]] = {}
        self._modules: set[str] = set()
        self._weights: dict[str, int] = {}

    @property
    def imports(self) -> tuple[str, ...]:
        """The modules of the message classes, sorted."""
        return tuple(sorted(self._modules, key=natural))

    @property
    def values(self) -> tuple[tuple[str, str], ...]:
        """Name and strategy of what is no message, in the order of use."""
        return tuple(self._values.items())

    @property
    def messages(self) -> tuple[tuple[str, str], ...]:
        """Name and strategy of messages, each after those that it needs."""
        return tuple(self._messages.values())

    def message_class(self, type_: Message | NamespacedType) -> str:
        """The name of a message class in the test module: `std_srvs.srv.SetBool.Request`."""
        self._modules.add(f"{type_.package}.{type_.folder}")
        interface = interface_name(type_)
        part = type_.name.removeprefix(interface).lstrip("_")
        return ".".join((type_.package, type_.folder, interface, *([part] if part else [])))

    def interface(self, type_name: str) -> str:
        """The name of an interface's class in the test module: `std_srvs.srv.SetBool`."""
        package, folder, name = type_name.split("/")
        self._modules.add(f"{package}.{folder}")
        return f"{package}.{folder}.{name}"

    def strategy_name(self, message: Message) -> str:
        """The name of the strategy for messages of this class, in the test module."""
        return f"{message.package}_{message.folder}_{message.name}"

    def message(self, message: Message) -> str:
        """The name of the strategy for messages of this class."""
        if message.type_name not in self._messages:
            constants = {field.name: values for field, values in context.values(message)}
            arguments = [
                f"{attribute_name(field)}={self._field(field, constants.get(field.name, ()))}"
                for field in message.fields
            ]
            name = self.strategy_name(message)
            strategy = enclosed("st.builds(", [self.message_class(message), *arguments], ")", len(name) + 3)
            self._messages[message.type_name] = name, strategy
        return self._messages[message.type_name][0]

    def _field(self, field: Field, constants: tuple[Constant, ...]) -> str:
        """The strategy for the values of a field, which are those of its meaning."""
        element = element_of(field.type)
        text = _within(element, meaning_of(field)) if isinstance(element, BasicType) else ""
        if text and not constants:
            return self.value(field.type, meant=text)
        return self.value(field.type, constants, closed=bool(constants) and is_closed(field))

    def value(
        self,
        type_: FieldType,
        constants: tuple[Constant, ...] = (),
        *,
        closed: bool = False,
        meant: str = "",
    ) -> str:
        """The strategy for the values of a field's type.

        `constants` are half of the values, all if they are `closed`; `meant` is the strategy for an element.
        """
        match type_:
            case Array(value_type, size):
                element = self.value(value_type, constants, closed=closed, meant=meant)
                return f"exactly({size}, {element}{self._drawn(value_type)})"
            case BoundedSequence(value_type, bound) if bound <= _DRAWN_AT_BOUND:
                element = self.value(value_type, constants, closed=closed, meant=meant)
                return f"at_most({bound}, {element}{self._drawn(value_type)})"
            case BoundedSequence(value_type) | UnboundedSequence(value_type):
                element = self.value(value_type, constants, closed=closed, meant=meant)
                return f"some({element}{self._drawn(value_type)})"
            case BasicType() if meant:
                return meant
            case BasicType(name):
                values = dict.fromkeys(repr(constant.value) for constant in constants)
                preferred = f"st.sampled_from([{', '.join(values)}])" if values else ""
                if preferred and closed:
                    return preferred
                return " | ".join(filter(None, (preferred, self._named(*_VALUES[name]))))
            case BoundedString(bound) | BoundedWString(bound):
                characters = _CHARACTERS if isinstance(type_, BoundedString) else _WIDE_CHARACTERS
                text = f"st.text({self._named(*characters)}, max_size={bound})"
                return f'{text} | st.just("x" * {bound})' if bound <= _DRAWN_AT_BOUND else text
            case UnboundedString():
                return self._text("STRINGS", *_CHARACTERS)
            case UnboundedWString():
                return self._text("WIDE_STRINGS", *_WIDE_CHARACTERS)
            case NamespacedType():
                return self.message(self._registry.message(type_.type_name))

    def _drawn(self, type_: ValueType) -> str:
        return ", drawn=1" if self._weight(type_) > _HEAVY else ""

    def _weight(self, type_: FieldType) -> int:
        """About how many values are drawn for one value of a type."""
        match type_:
            case NamespacedType(package, folder, name):
                key = f"{package}/{folder}/{name}"
                if key not in self._weights:
                    fields = self._registry.message(key).fields
                    self._weights[key] = 1 + sum(self._weight(field.type) for field in fields)
                return self._weights[key]
            case Array(element) | BoundedSequence(element) | UnboundedSequence(element):
                weight = self._weight(element)
                return weight if weight > _HEAVY else 3 * weight
            case _:
                return 1

    def _text(self, name: str, characters: str, strategy: str) -> str:
        return self._named(name, f"st.text({self._named(characters, strategy)}, max_size=12)")

    def _named(self, name: str, strategy: str) -> str:
        self._values[name] = strategy
        return name


def _within(type_: BasicType, meaning: Meaning) -> str:
    """The strategy for a number in its range, or for its invalid value; empty if no range fits its type.

    NaN is left out, because it equals nothing.
    """
    if meaning.range is None or type_.typename in {"boolean", "octet", "char"}:
        return ""
    if type_.typename in INTEGER_RANGES:
        least, most = INTEGER_RANGES[type_.typename]
        low = least if meaning.range.minimum is None else max(least, math.ceil(meaning.range.minimum))
        high = most if meaning.range.maximum is None else min(most, math.floor(meaning.range.maximum))
        found = f"st.integers({low}, {high})" if low <= high else ""
    else:
        found = _floats(meaning.range, 32 if type_.typename == "float" else 64)
    invalid = meaning.invalid
    if not found or invalid is None or math.isnan(invalid.value) or invalid.value in meaning.range:
        return found
    return f"{found} | st.just({invalid.value if isinstance(invalid.value, int) else float(invalid.value)})"


def _floats(range_: Range, bits: int) -> str:
    """Floats in a range, whose bounds become floats of the given number of bits."""
    low, high = (None if bound is None else float(bound) for bound in (range_.minimum, range_.maximum))
    if bits == 32:
        low, high = _float32(low, math.inf), _float32(high, -math.inf)
        if (low is not None and math.isinf(low)) or (high is not None and math.isinf(high)):
            return ""
    if low is not None and high is not None and low > high:
        return ""
    bounds = {"min_value": low, "max_value": high}
    given = [f"{name}={bound!r}" for name, bound in bounds.items() if bound is not None]
    width = ", width=32" if bits == 32 else ""
    return f"st.floats({', '.join(given)}, allow_nan=False, allow_infinity=False{width})"


def _float32(bound: float | None, towards: float) -> float | None:
    """The float32 next to a bound, on the side that is within the range."""
    if bound is None:
        return None
    rounded = array("f", [bound])[0]
    is_outside = rounded < bound if towards > 0 else rounded > bound
    if not is_outside or math.isinf(rounded):
        return rounded
    step = math.ulp(1.0) * 2**29 * max(abs(rounded), 2.0**-126)
    return array("f", [rounded + math.copysign(step, towards)])[0]


def enclosed(opening: str, parts: Iterable[str], closing: str, column: int, indent: int = 0) -> str:
    """`opening part, part closing`; a line a part where that does not fit into a line from `column` on."""
    parts = list(parts)
    line = f"{opening}{', '.join(parts)}{closing}"
    if column + len(line) < LINE_LENGTH and "\n" not in line:
        return line
    margin = " " * indent
    return f"{opening}\n" + "".join(f"{margin}    {part},\n" for part in parts) + f"{margin}{closing}"
