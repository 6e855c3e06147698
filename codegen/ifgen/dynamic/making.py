"""From definitions to classes: the generated text of each type is executed in a module of its own.

Nothing gets into `sys.modules`. A module finds the classes that it imports among those that were made with
it, so two versions of a type never meet. Names are safe to execute, because whoever reads definitions checks
them.
"""

from __future__ import annotations

import builtins
import copyreg
import gc
import hashlib
from collections.abc import Generator, Iterable, Mapping
from contextlib import contextmanager
from functools import cache, partial
from importlib import import_module
from threading import RLock
from types import SimpleNamespace
from typing import Any, Final, get_type_hints

from ifgen.definition.interfaces import Action, Message, Registry
from ifgen.definition.references import references
from ifgen.definition.type_description import Described
from ifgen.diagnostics import Diagnostic, InputError
from ifgen.generator_py.codec.text import CodecText, render
from ifgen.generator_py.messages.classes import Facts
from ifgen.generator_py.messages.package import plan_alone
from ifgen.generator_py.names import class_reference, module_name, slot_name
from ifgen.generator_py.templates.render import Templates
from ifgen.wire.plan import plan

_RUNTIME: Final = "ifgen_runtime.codec"
_NONE: Final = CodecText((), (), (), "", "", "pass")
_METHODS: Final = ("__serialize__", "__deserialize__", "__codec__")
_PARTS: Final = ("__write__", "__read__")
"""The functions that only large messages have, for the codecs of messages that contain them."""

_codec_lock: Final = RLock()


class FactsWithoutCodecs(Facts):
    """The facts for modules of classes whose codecs come later."""

    def codec(self, message: Message) -> CodecText:
        """A statement that does nothing."""
        return _NONE


class _Later:
    """An attribute of a class that makes the codec when somebody reads it."""

    def __init__(self, name: str, attach: Any) -> None:
        self._name = name
        self._attach = attach

    def __get__(self, message: object, owner: type[Any]) -> Any:
        self._attach()
        return getattr(owner if message is None else message, self._name)


def attach_later(
    cls: Any,
    nested: tuple[type[Any], ...],
    module: dict[str, Any],
    message: Message,
    facts: Facts,
    made: Mapping[str, type[Any]],
) -> None:
    """Let a class get its codec when that is first used; `nested` are the classes of its fields.

    `made` are the classes of all types that it refers to, by type name.
    """
    cls.__nested__ = nested
    attach = partial(_attach, cls, module, message, facts, made)
    is_large = facts.extents.of(message).is_large
    for name in (*_METHODS, *(_PARTS if is_large else ())):
        setattr(cls, name, _Later(name, attach))


def _is_later(cls: type[Any], name: str) -> bool:
    return isinstance(vars(cls).get(name), _Later)


def _attach(
    cls: type[Any], module: dict[str, Any], message: Message, facts: Facts, made: Mapping[str, type[Any]]
) -> None:
    """Execute the text of the codec in the module of the class."""
    with _codec_lock:
        if not _is_later(cls, "__serialize__"):
            return  # another thread was first
        codec = render(plan(message, facts.extents, slot_name))
        for type_ in codec.class_types:
            nested = made[type_.type_name]
            module[class_reference(type_, message)] = nested
            if _is_later(nested, "__write__"):
                nested.__write__  # noqa: B018 - large ones are called, and have to be complete
        runtime = import_module(_RUNTIME)
        module.update({name: getattr(runtime, name) for name in codec.runtime_imports})
        text = "\n".join((*codec.constants, codec.serialize, codec.deserialize, codec.attachment))
        code = compile(text, f"<ifgen.dynamic codec of {message.type_name}>", "exec", dont_inherit=True)
        for name in (*_METHODS, *_PARTS):
            if _is_later(cls, name):
                delattr(cls, name)
        exec(code, module)
        import_module("ifgen_runtime.codec.choice").attached(cls)


_PACKAGES: Final = "__ifgen_packages__"
"""The name in a module of the classes that it imports, by `package.folder`."""

_classes: Final[dict[str, type[Any]]] = {}
_lock: Final = RLock()


def make(described: Described, registry: Registry) -> type[Any]:
    """The class of a type: the one that was made before, if its definition is the same."""
    with _lock, _without_garbage_collection():
        return _Making(registry).class_of(described)


class _Making:
    """Makes classes of the types in a registry, those that a class needs first."""

    def __init__(self, registry: Registry) -> None:
        self._facts = FactsWithoutCodecs(registry)
        self._texts: dict[str, str] = {}
        self._made: dict[str, type[Any]] = {}

    def class_of(self, described: Described) -> type[Any]:
        """The class of a type. All types that it refers to have classes then, too."""
        referenced = self._facts.hashes.referenced
        for item in sorted((described, *referenced(described)), key=lambda item: len(referenced(item))):
            key = self._key(item, referenced(item))
            cls = _classes.get(key)
            if cls is None:
                cls = _classes[key] = self._make(item, referenced(item))
            self._made[item.type_name] = cls
        return self._made[described.type_name]

    def _key(self, described: Described, needed: Iterable[Described]) -> str:
        """The type hash, with a digest of the definitions that it stands for; comments do not count."""
        text = "\n".join(map(self._text, (described, *needed)))
        return f"{self._facts.hashes.of(described)} {hashlib.sha256(text.encode()).hexdigest()}"

    def _text(self, described: Described) -> str:
        name = described.type_name
        if name not in self._texts:
            own: list[object] = [name]
            if isinstance(described, Message):
                own += ((field.name, field.type, field.default_value) for field in described.fields)
                own += ((constant.name, constant.type, constant.value) for constant in described.constants)
            self._texts[name] = repr(own)
        return self._texts[name]

    def _make(self, described: Described, needed: list[Described]) -> type[Any]:
        type_hash = self._facts.hashes.of(described)
        file_name = f"<ifgen.dynamic {described.type_name} {type_hash}>"
        text = _templates().render(plan_alone(described, self._facts)).text
        # The last part tells versions apart. No module can have such a name, so pickle finds no other class.
        own = f"{described.package}.{described.folder}"
        module: dict[str, Any] = {"__name__": f"{own}.{module_name(described.name)}@{type_hash[7:15]}"}
        packages: dict[str, dict[str, type[Any]]] = {}
        for item in needed:
            packages.setdefault(f"{item.package}.{item.folder}", {})[item.name] = self._made[item.type_name]
        module |= packages.get(own, {})
        module[_PACKAGES] = {name: SimpleNamespace(**classes) for name, classes in packages.items()}
        module["__builtins__"] = _builtins()
        try:
            exec(compile(text, file_name, "exec", dont_inherit=True), module)
        except ImportError as error:
            raise InputError([_missing(described, error)]) from error
        _resolve_hints(module)
        cls: type[Any] = module[described.name]
        if isinstance(described, Message):
            nested = tuple(self._made[type_.type_name] for _, type_ in references(described))
            attach_later(cls, nested, module, described, self._facts, self._made)
        definition = (described, *needed)
        copyreg.pickle(type(cls), lambda _: (_restored, (described.type_name, definition)))
        return cls


def _resolve_hints(module: dict[str, Any]) -> None:
    """Put classes in the place of names in annotations: no import finds the module that has these names."""
    for cls in module.values():
        if "__type_hash__" in getattr(cls, "__dict__", ()) and cls.__module__ == module["__name__"]:
            cls.__annotations__ = get_type_hints(cls, module, include_extras=True)


def _restored(type_name: str, definition: tuple[Described, ...]) -> type[Any]:
    """The class that was pickled: made again, where it does not exist."""
    described = next(item for item in definition if item.type_name == type_name)
    return make(described, Registry.of_interfaces(definition))


def _missing(described: Described, error: ImportError) -> Diagnostic:
    message = f"the class of {described.type_name} cannot be made: {error}"
    what = "action_msgs and " if isinstance(described, Action) else ""
    help = f"it needs {what}ifgen_runtime: run the program with `ifgen run`, or call `ifgen.activate()` first"
    return Diagnostic("no-runtime", message, help=help)


@cache
def _templates() -> Templates:
    return Templates()


@cache
def _builtins() -> dict[str, Any]:
    """Python's own names, with an `import` that looks among a module's own classes first."""
    ordinary = builtins.__import__

    def import_(
        name: str,
        module: Mapping[str, Any] | None = None,
        names: Mapping[str, Any] | None = None,
        wanted: tuple[str, ...] | None = (),
        level: int = 0,
    ) -> Any:
        packages: dict[str, object] = module.get(_PACKAGES, {}) if module is not None else {}
        found = packages.get(name)
        if found is not None and all(hasattr(found, item) for item in wanted or ()):
            return found
        return ordinary(name, module, names, wanted or (), level)

    return {**vars(builtins), "__import__": import_}


@contextmanager
def _without_garbage_collection() -> Generator[None]:
    """Collect nothing meanwhile: many small objects are made, and all of them stay or go at once."""
    was_on = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if was_on:
            gc.enable()
