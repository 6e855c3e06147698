"""The parameters that a node takes."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, TypeAlias

from launch.substitution import Substitution

from launch_ros.parameter_descriptions import Parameter, ParameterFile

SomeParameterFile: TypeAlias = str | Path | Substitution | ParameterFile
SomeParametersDict: TypeAlias = Mapping[Any, Any]
SomeParameters: TypeAlias = Sequence[SomeParameterFile | SomeParametersDict | Parameter]
"""Files, and values by name, which may be nested."""
ParametersDict: TypeAlias = dict[tuple[Substitution, ...], Any]
Parameters: TypeAlias = Sequence[ParameterFile | ParametersDict | Parameter]
EvaluatedParameters: TypeAlias = tuple[Path | dict[str, Any], ...]
"""The same with paths and values in place of substitutions."""
