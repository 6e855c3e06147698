"""Launch files in XML and YAML: their elements, and what those stand for."""

from launch._errors import LaunchError as InvalidFrontendLaunchFileError
from launch.frontend.entity import Entity
from launch.frontend.expose import expose_action, expose_substitution
from launch.frontend.parser import Parser

__all__ = [
    "Entity",
    "InvalidFrontendLaunchFileError",
    "Parser",
    "expose_action",
    "expose_substitution",
]
