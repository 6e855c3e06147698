"""Launch files in XML."""

from launch.frontend import Entity

from launch_xml.parser import Parser

__all__ = ["Entity", "Parser"]
