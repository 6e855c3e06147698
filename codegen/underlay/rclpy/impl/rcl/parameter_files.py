"""Reads parameter files into overrides."""

from __future__ import annotations

from ifgen_runtime import parameter_yaml

from .lexer import RuleError
from .parameters import ParameterOverrides

__all__ = ["read_file"]


def read_file(path: str, overrides: ParameterOverrides) -> None:
    """Read a parameter file into `overrides`; raises RuleError."""
    try:
        parameter_yaml.read_file(path, overrides.entry)
    except parameter_yaml.ParameterYamlError as error:
        raise RuleError(str(error)) from None
