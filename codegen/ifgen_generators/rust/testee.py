"""The part of the testee that depends on the interfaces."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from ifgen.model import Field, Interface, Message

from ifgen_generators.rust.codec import borrows, key


def canonical(
    interfaces: Sequence[Interface], types: Mapping[str, Message], crate: str, views: bool
) -> Iterator[str]:
    """The code for each type: its canonical text, that of its view, and the functions to call."""
    messages = [message for interface in interfaces for message in interface.types]
    paths = {message.type_name: f"{crate}::{message.type_name.replace('/', '::')}" for message in messages}
    borrowed = {message.type_name for message in messages if views and borrows(message, types)}
    for message in messages:
        path = paths[message.type_name]
        yield from _dump(message, path)
        if message.type_name in borrowed:
            yield from _dump(message, f"{path}View<'_>")
        unused = "" if message.fields else "_"
        yield f"impl Load for {path} {{\n    fn load({unused}words: &mut Words) -> Self {{\n        Self {{\n"
        for field in message.fields:
            load = "load_wide(words)" if field.type.primitive == "wstring" else "Load::load(words)"
            yield f"            {key(field.name)}: {load},\n"
        yield "        }\n    }\n}\n"
    yield "\nfn answer(op: &str, name: &str, words: &[&str]) -> Answer {\n    match name {\n"
    for message in messages:
        path = paths[message.type_name]
        view = f"{path}{'View' if message.type_name in borrowed else ''}::decode(data).map(|m| all(&m))"
        yield f'        "{message.type_name}" => of::<{path}>(op, words, |data| {view}, '
        yield "|name| match name {\n"
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


def _dump(message: Message, path: str) -> Iterator[str]:
    unused = "" if message.fields else "_"
    yield f"\nimpl Dump for {path} {{\n"
    yield f"    fn dump(&self, {unused}path: &str, {unused}out: &mut Vec<String>) {{\n"
    for field in message.fields:
        yield f'        {_wide(field, f"self.{key(field.name)}")}.dump(&join(path, "{field.name}"), out);\n'
    yield "    }\n}\n"


def _wide(field: Field, value: str) -> str:
    return f"Wide(&{value})" if field.type.primitive == "wstring" else value
