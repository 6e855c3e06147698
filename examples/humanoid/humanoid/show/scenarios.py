"""The scenarios: files of parameters, which say what the robot does, and what people do meanwhile.

A scenario is what a launch file passes to the nodes as well: `config/scenarios/NAME.yaml`, a parameter file
of ROS with the tasks of high_level_task_manager and the events of audience.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import yaml

Parameters = Mapping[str, Mapping[str, Any]]
"""Values by node and parameter."""


class ScenarioFileError(ValueError):
    """A scenario cannot be read; the text says why."""


def folder() -> Path:
    """The folder of the scenarios: beside the library, or where it is installed."""
    above = Path(__file__).resolve().parents
    places = [above[2], *(folder / "share" / "humanoid" for folder in above[3:])]
    found = [place / "config" / "scenarios" for place in places]
    return next((place for place in found if place.is_dir()), found[0])


def names() -> list[str]:
    """The scenarios that there are."""
    return sorted(path.stem for path in folder().glob("*.yaml"))


def find(name: str) -> Path:
    """The file of a scenario: its name, or the path of a file. Raises ScenarioFileError."""
    path = Path(name) if name.endswith((".yaml", ".yml")) else folder() / f"{name}.yaml"
    if not path.is_file():
        known = ", ".join(names())
        raise ScenarioFileError(f"there is no scenario {name}: choose one of {known}, or a .yaml file")
    return path.resolve()


def read(name: str) -> Parameters:
    """The parameters of a scenario: its name, or the path of a file. Raises ScenarioFileError."""
    path = find(name)
    try:
        said = yaml.safe_load(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError) as error:
        raise ScenarioFileError(f"{path} cannot be read: {error}") from None
    except yaml.YAMLError as error:
        raise ScenarioFileError(f"{path} is not YAML: {' '.join(str(error).split())}") from None
    return _parameters(path, said or {})


def needs_eyes(parameters: Parameters) -> bool:
    """Whether there is something in a scenario that the robot must see: obstacles."""
    return bool(parameters.get("humanoid_simulator", {}).get("obstacles"))


def _parameters(path: Path, said: Any) -> Parameters:
    found: dict[str, dict[str, Any]] = {}
    for node, content in said.items() if isinstance(said, dict) else [("", said)]:
        values = content.get("ros__parameters") if isinstance(content, dict) else None
        if not isinstance(node, str) or not isinstance(values, dict):
            raise ScenarioFileError(
                f"{path}: expected nodes with `ros__parameters`, as in a parameter file of ROS"
            )
        found[node.strip("/")] = values
    return found
