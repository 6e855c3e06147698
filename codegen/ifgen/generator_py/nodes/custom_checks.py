"""The functions of custom validators that a package has to bring, in modules of the user's."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from ifgen.generator_py.messages.docstrings import docstring
from ifgen.generator_py.nodes.context import ChecksModule
from ifgen.generator_py.nodes.parameters import annotation, declared
from ifgen.generator_py.nodes.text import literal
from ifgen.nodl.model import NodePackage, Parameter, Validator


def checks_modules(package: NodePackage) -> Mapping[str, ChecksModule]:
    """The modules of this package with functions of custom validators, by path in its inner folder."""
    functions: dict[str, dict[str, tuple[str, str, str]]] = {}
    for parameter, validator, module, name in _functions(package):
        of_module = functions.setdefault(module, {})
        of_module.setdefault(
            name, (name, _parameters(parameter, validator), _docstring(parameter, validator))
        )
    return {
        f"{module.replace('.', '/')}.py": ChecksModule(
            f"Checks of parameters of {package.name}: written once by ifgen, yours from then on.",
            tuple(of_module.values()),
        )
        for module, of_module in functions.items()
    }


def _functions(package: NodePackage) -> Iterator[tuple[Parameter, Validator, str, str]]:
    for node in package.nodes:
        for parameter in declared(node):
            for validator in parameter.validators:
                path = validator.function or ""
                if path.startswith(f"{package.name}."):
                    module, _, name = path.removeprefix(f"{package.name}.").rpartition(".")
                    if module:
                        yield parameter, validator, module, name


def _parameters(parameter: Parameter, validator: Validator) -> str:
    arguments = (
        f"argument{number}: {type(value).__name__}" for number, value in enumerate(validator.arguments, 1)
    )
    return ", ".join([f"value: {annotation(parameter.type)}", *arguments])


def _docstring(parameter: Parameter, validator: Validator) -> str:
    given = f" with {', '.join(map(literal, validator.arguments))}" if validator.arguments else ""
    text = (
        f"Check `{parameter.name}` ({validator.name}{given}); raise ValueError with the reason to refuse it."
    )
    return docstring(text, indent=4)
