"""The entry point of the package: prints how it was started, and ends with 7."""

import sys

import helper  # noqa: F401

from .limits import SPEED

print("robot itself", SPEED, sys.argv[1:], type(__spec__.name), __spec__.name)
sys.exit(7)
