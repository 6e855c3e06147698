"""Launch files in YAML."""

from launch.frontend import Entity

from launch_yaml.parser import Parser

__all__ = ["Entity", "Parser"]
