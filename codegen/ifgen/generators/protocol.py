"""The JSON that programs speak: a request on stdin, an answer on stdout."""

from __future__ import annotations

import base64
import binascii
import json
from collections.abc import Mapping, Sequence
from typing import Any, Final, cast, get_args

from ifgen.generators import FEATURES, File, Finding, Generator, Option, OptionType, Request, Response
from ifgen.model import VERSION, document

PROTOCOL: Final = 1
"""The version of the protocol: `ifgen` in each request."""


def describe_request() -> str:
    """The request that a program answers with what it is."""
    return json.dumps({"ifgen": PROTOCOL, "request": "describe"}) + "\n"


def generate_request(request: Request) -> str:
    """The request that a program answers with files. It is ASCII, which a program reads in any locale."""
    asked = {
        "ifgen": PROTOCOL,
        "request": "generate",
        "model": document(request.model),
        "options": dict(request.options),
        "target": {"name": request.name},
    }
    return json.dumps(asked) + "\n"


def described(answer: object, name: str) -> Generator:
    """The description of a program. Raises ValueError in words if the answer is none."""
    found = _object(answer, "the answer")
    features = found.get("features")
    if features is not None:
        features = frozenset(_texts(features, "'features'"))
        if unknown := sorted(features - FEATURES.keys()):
            raise ValueError(f"'features' has {unknown[0]!r}; ifgen knows {', '.join(FEATURES)}")
    return Generator(
        name=_text(found.get("name", name), "'name'"),
        version=_text(found.get("version", ""), "'version'"),
        description=_text(found.get("description", ""), "'description'"),
        model=_text(found.get("model", VERSION), "'model'"),
        features=features,
        options=tuple(_option(each) for each in _list(found.get("options", []), "'options'")),
    )


def description(generator: Generator) -> dict[str, Any]:
    """The same as JSON."""
    return {
        "name": generator.name,
        "version": generator.version,
        "description": generator.description,
        "model": generator.model,
        "features": sorted(FEATURES if generator.features is None else generator.features),
        "options": [
            {
                "name": option.name,
                "type": option.type,
                "default": option.default,
                "help": option.help,
                **({"choices": list(option.choices)} if option.choices else {}),
            }
            for option in generator.options
        ],
    }


def response(answer: object) -> Response:
    """The files and findings of an answer. Raises ValueError in words if it is none."""
    found = _object(answer, "the answer")
    if "files" not in found and "diagnostics" not in found:
        raise ValueError("the answer has neither 'files' nor 'diagnostics'")
    return Response(
        tuple(_file(each) for each in _list(found.get("files", []), "'files'")),
        tuple(_finding(each) for each in _list(found.get("diagnostics", []), "'diagnostics'")),
    )


def _file(value: object) -> File:
    found = _object(value, "an element of 'files'")
    path = _text(found.get("path"), "'path' of a file")
    if ("text" in found) == ("base64" in found):
        raise ValueError(f"the file {path!r} needs either 'text' or 'base64'")
    if "text" in found:
        return File(path, _text(found["text"], f"'text' of {path!r}"))
    try:
        data = base64.b64decode(_text(found["base64"], f"'base64' of {path!r}"), validate=True)
    except binascii.Error as error:
        raise ValueError(f"'base64' of {path!r} is none: {error}") from None
    return File(path, data)


def _finding(value: object) -> Finding:
    found = _object(value, "an element of 'diagnostics'")
    severity = found.get("severity", "error")
    if severity not in {"error", "warning"}:
        raise ValueError(f"'severity' of a diagnostic is {severity!r}, and must be 'error' or 'warning'")
    element, help_ = found.get("element"), found.get("help")
    return Finding(
        None if element is None else _text(element, "'element' of a diagnostic"),
        _text(found.get("message"), "'message' of a diagnostic"),
        severity,
        None if help_ is None else _text(help_, "'help' of a diagnostic"),
    )


def _option(value: object) -> Option:
    found = _object(value, "an element of 'options'")
    name = _text(found.get("name"), "'name' of an option")
    type_ = found.get("type")
    if type_ not in get_args(OptionType):
        raise ValueError(f"'type' of option {name!r} must be one of {', '.join(get_args(OptionType))}")
    return Option(
        name,
        cast("OptionType", type_),
        found.get("default"),
        _text(found.get("help", ""), f"'help' of option {name!r}"),
        tuple(_texts(found.get("choices", []), f"'choices' of option {name!r}")),
    )


def _object(value: object, what: str) -> Mapping[str, Any]:
    if not isinstance(value, dict):
        raise ValueError(f"{what} is no JSON object")
    return cast("dict[str, Any]", value)


def _list(value: object, what: str) -> Sequence[object]:
    if not isinstance(value, list):
        raise ValueError(f"{what} is no JSON array")
    return cast("list[object]", value)


def _text(value: object, what: str) -> str:
    if not isinstance(value, str):
        raise ValueError(f"{what} is no text")
    return value


def _texts(value: object, what: str) -> list[str]:
    return [_text(element, f"an element of {what}") for element in _list(value, what)]
