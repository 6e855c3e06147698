"""Is run with -m: relative imports, resources of the package."""

import importlib.resources
import os
import sys
import threading
from pathlib import Path

import helper

from . import limits
from .limits import SPEED

print(helper.WHO, limits.SPEED, SPEED, __name__, __package__, __spec__.name, Path(__file__).name)
print(Path(sys.argv[0]).name, sys.argv[1:], sys.path[0] == str(Path.cwd()))
os.chdir(os.pardir)
threading.Event().wait(0.1)
print(Path.cwd().name)
print(importlib.resources.files("robot").joinpath("limits.py").read_text())
