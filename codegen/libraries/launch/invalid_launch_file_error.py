"""The error of launch files that cannot be read, under upstream's name."""

from launch._errors import LaunchError as InvalidLaunchFileError

__all__ = ["InvalidLaunchFileError"]
