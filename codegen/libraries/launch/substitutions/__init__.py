"""Texts that a description computes when it runs."""

from launch.substitutions._expressions import (
    AllSubstitution,
    AndSubstitution,
    AnySubstitution,
    EqualsSubstitution,
    IfElseSubstitution,
    NotEqualsSubstitution,
    NotSubstitution,
    OrSubstitution,
    PythonExpression,
)
from launch.substitutions._places import (
    FileContent,
    FindExecutable,
    LaunchLogDir,
    PathJoinSubstitution,
    PathSubstitution,
    ThisLaunchFile,
    ThisLaunchFileDir,
)
from launch.substitutions._system import AnonName, Command, EnvironmentVariable
from launch.substitutions._texts import (
    LaunchConfiguration,
    LocalSubstitution,
    StringJoinSubstitution,
    TextSubstitution,
)
from launch.substitutions.substitution_failure import SubstitutionFailure

__all__ = [
    "AllSubstitution",
    "AndSubstitution",
    "AnonName",
    "AnySubstitution",
    "Command",
    "EnvironmentVariable",
    "EqualsSubstitution",
    "FileContent",
    "FindExecutable",
    "IfElseSubstitution",
    "LaunchConfiguration",
    "LaunchLogDir",
    "LocalSubstitution",
    "NotEqualsSubstitution",
    "NotSubstitution",
    "OrSubstitution",
    "PathJoinSubstitution",
    "PathSubstitution",
    "PythonExpression",
    "StringJoinSubstitution",
    "SubstitutionFailure",
    "TextSubstitution",
    "ThisLaunchFile",
    "ThisLaunchFileDir",
]
