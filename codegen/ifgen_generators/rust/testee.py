"""The part of the testee that depends on the interfaces."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ifgen.model import Field, Interface

from ifgen_generators.rust.codec import key


def canonical(interfaces: Sequence[Interface], crate: str) -> Iterator[str]:
    """The code for each type: its canonical text, and the functions to call."""
    messages = [message for interface in interfaces for message in interface.types]
    for message in messages:
        path = f"{crate}::{message.type_name.replace('/', '::')}"
        yield f"\nimpl Canonical for {path} {{\n"
        unused = "" if message.fields else "_"
        yield f"    fn dump(&self, {unused}path: &str, {unused}out: &mut Vec<String>) {{\n"
        for field in message.fields:
            value = f"self.{key(field.name)}"
            yield f'        {_wide(field, value)}.dump(&join(path, "{field.name}"), out);\n'
        yield "    }\n"
        yield f"    fn load({unused}words: &mut Words) -> Self {{\n        Self {{\n"
        for field in message.fields:
            load = "load_wide(words)" if field.type.primitive == "wstring" else "Canonical::load(words)"
            yield f"            {key(field.name)}: {load},\n"
        yield "        }\n    }\n}\n"
    yield "\nfn answer(op: &str, name: &str, words: &[&str]) -> Answer {\n    match name {\n"
    for message in messages:
        path = f"{crate}::{message.type_name.replace('/', '::')}"
        yield f'        "{message.type_name}" => of::<{path}>(op, words, |name| match name {{\n'
        for constant in message.constants:
            value = f"{path}::{constant.name}"
            wide = "wide" if constant.type.primitive == "wstring" else "text"
            yield f'            "{constant.name}" => Some({wide}(&{value})),\n'
        yield "            _ => None,\n        }),\n"
    for interface in interfaces:
        services = {service.type_name: service.type_hash for service in interface.services}
        for type_name, type_hash in ({interface.type_name: interface.type_hash} | services).items():
            if interface.kind != "message":
                yield f'        "{type_name}" if op == "hash" => Answer::Ok("{type_hash}".into()),\n'
    yield '        _ => Answer::Skip("unknown-type"),\n    }\n}\n'


def _wide(field: Field, value: str) -> str:
    return f"Wide(&{value})" if field.type.primitive == "wstring" else value
