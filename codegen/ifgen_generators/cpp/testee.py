"""The testee of the conformance suite: a program that knows all types of a model."""

from __future__ import annotations

from collections.abc import Iterator

from ifgen.model import Interface, Model, Package, safe_name

from ifgen_generators import c_family
from ifgen_generators.cpp.headers import constant_name, qualified


def testee(model: Model) -> Iterator[tuple[str, str]]:
    """The files of the program: one for each package, which takes a while to compile, and `main`."""
    packages = c_family.generated_packages(model)
    for package in packages:
        yield f"testee/{package.name}.cpp", _package(package)
    adds = [f"add_{package.name}" for package in packages]
    lines = [
        '#include "testee.hpp"',
        "",
        *(f"void {add}(ifgen::testee::Types & types);" for add in adds),
        "",
        "int main()\n{",
        "  ifgen::testee::Types types;",
        *(f"  {add}(types);" for add in adds),
        "  return ifgen::testee::main(types);\n}\n",
    ]
    yield "testee/main.cpp", "\n".join(lines)


def _package(package: Package) -> str:
    return "\n".join(
        [
            '#include "testee.hpp"',
            *(f'#include "{c_family.path(interface, "hpp")}"' for interface in package.interfaces),
            "",
            f"void add_{package.name}(ifgen::testee::Types & types);",
            "",
            f"void add_{package.name}(ifgen::testee::Types & types)\n{{",
            "  using ifgen::testee::answer;\n  using ifgen::testee::text_of;",
            *(line for interface in package.interfaces for line in _interface(interface)),
            "}\n",
        ]
    )


def _interface(interface: Interface) -> Iterator[str]:
    for message in interface.types:
        name = qualified(message)
        constants = ", ".join(
            f'{{"{constant.name}", text_of({name}::{constant_name(constant)})}}'
            for constant in message.constants
        )
        yield _type(message.type_name, name, f"answer<{name}>", constants)
    names = [service.name for service in interface.services]
    names += [interface.name] if interface.kind == "action" else []
    for of in names:
        name = f"::{safe_name(interface.package, 'cpp')}::{interface.folder}::{of}"
        yield _type(f"{interface.package}/{interface.folder}/{of}", name, "nullptr", "")


def _type(type_name: str, name: str, answer: str, constants: str) -> str:
    return f'  types["{type_name}"] = {{ifgen::type_hash<{name}>, {answer}, {{{constants}}}}};'
