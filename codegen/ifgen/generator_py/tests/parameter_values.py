"""Values of parameters to try in tests: some that keep all rules, and for each rule one that breaks it."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from itertools import cycle, islice

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
