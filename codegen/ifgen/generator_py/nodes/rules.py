"""The validators of a parameter in Python, and in words."""

from __future__ import annotations

from collections.abc import Iterator

from ifgen.generator_py.nodes.text import literal
from ifgen.nodl.model import Parameter, Validator

_NUMBERS = {
    "bounds": ("{0} <= {value} <= {1}", "must be from {0} to {1}"),
    "lt": ("{value} < {0}", "must be less than {0}"),
    "gt": ("{value} > {0}", "must be greater than {0}"),
    "lt_eq": ("{value} <= {0}", "must be at most {0}"),
    "gt_eq": ("{value} >= {0}", "must be at least {0}"),
}
_ELEMENTS = {
    "element_bounds": "bounds",
    "lower_element_bounds": "gt_eq",
    "upper_element_bounds": "lt_eq",
}
_SIZES = {
    "fixed_size": ("==", "exactly"),
    "size_gt": (">", "more than"),
    "size_lt": ("<", "fewer than"),
}


def rules(parameter: Parameter) -> Iterator[tuple[str, str]]:
    """An expression of `value` and what it asks for (`must be ...`), for each rule but the custom ones."""
    size = parameter.type.fixed_size
    if size is not None:
        yield f"len(value) <= {size}", f"must have at most {_counted(size, parameter)}"
    for validator in parameter.validators:
        if validator.function is None:
            yield _rule(validator, parameter)


def checks(parameter: Parameter) -> Iterator[tuple[str, tuple[str, ...]]]:
    """The functions of custom validators by their dotted paths, and their arguments as literals."""
    for validator in parameter.validators:
        if validator.function is not None:
            yield validator.function, tuple(map(literal, validator.arguments))


def _rule(validator: Validator, parameter: Parameter) -> tuple[str, str]:
    name = validator.name
    arguments = [literal(argument) for argument in validator.arguments]
    if name in _NUMBERS:
        test, text = _NUMBERS[name]
        return test.format(*arguments, value="value"), text.format(*arguments)
    if name in _ELEMENTS:
        test, text = _NUMBERS[_ELEMENTS[name]]
        return (
            f"all({test.format(*arguments, value='element')} for element in value)",
            f"each element {text.format(*arguments)}",
        )
    if name in _SIZES:
        operator, text = _SIZES[name]
        size = int(validator.arguments[0])
        return f"len(value) {operator} {size}", f"must have {text} {_counted(size, parameter)}"
    choices = ", ".join(arguments)
    match name:
        case "one_of":
            return f"value in [{choices}]", f"must be one of {choices}"
        case "subset_of":
            return (
                f"all(element in [{choices}] for element in value)",
                f"each element must be one of {choices}",
            )
        case "unique":
            return "len(set(value)) == len(value)", "must not hold a value twice"
        case "not_empty":
            return "len(value) > 0", "must not be empty"
        case _:
            raise ValueError(f"no rule for the validator {name}")


def _counted(size: int, parameter: Parameter) -> str:
    noun = "element" if parameter.type.array else "character"
    return f"{size} {noun}{'' if size == 1 else 's'}"
