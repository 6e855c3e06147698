"""Looks at `__main__`, at modules next to the program, and at their places."""

from __future__ import annotations

import copy
import dataclasses
import enum
import functools
import importlib
import inspect
import pickle
import pkgutil
import random
import sys
import threading
import typing
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import helper
from helper import WHO, Reading

import __main__

HERE = Path(__file__).parent


class Mode(enum.Enum):
    IDLE = 0


@dataclasses.dataclass
class Message:
    counted: typing.ClassVar[int] = 0
    text: str = "hello"
    mode: Mode = Mode.IDLE

    def told(self) -> str:
        return f"{self.text} from {WHO}"


def double(value: int) -> int:
    return 2 * value


def look() -> None:
    print(__name__, __main__.Message is Message, sys.modules["__main__"] is __main__, __spec__, __package__)
    print(HERE.name, Path(__file__).is_absolute(), vars(__main__) is globals())
    print([field.name for field in dataclasses.fields(Message)], typing.get_type_hints(Message)["mode"])
    print(pickle.loads(pickle.dumps(Message("pickled"))), pickle.loads(pickle.dumps(double))(21))
    print(pickle.loads(pickle.dumps(Reading(0.1))) == Reading(0.1), copy.deepcopy(Message()) == Message())
    print(
        inspect.getsource(double),
        inspect.getmodule(Message) is __main__,
        inspect.getfile(Message) == __file__,
    )
    print(WHO, helper.WHO, sys.modules["helper"] is helper, importlib.import_module("helper") is helper)
    print(helper.__name__, helper.__spec__.name == "helper", Path(helper.__file__).parent == HERE)
    print(type(helper.__name__), Reading.__module__, type(Reading.__module__), "helper" in sys.modules)
    print(sys.path[0] == str(HERE), (HERE / "data.txt").read_text().strip())
    print(pkgutil.find_loader("helper") is not None if hasattr(pkgutil, "find_loader") else True)


look()
random.seed(7)
print([random.random() for _ in range(20) if not threading.Event().wait(0.01)])
helper.COUNT += 1
print(importlib.reload(helper) is helper, helper.COUNT)
with ThreadPoolExecutor(1) as pool:
    pool.submit(look).result()
try:
    import nowhere_to_be_found  # noqa: F401
except ImportError as error:
    print(error, error.name)
sys.path.append(str(HERE / "robot"))
import limits  # noqa: E402

print(limits.SPEED, functools.reduce(max, [1, 2]))
del sys.modules["limits"]
print("limits" in sys.modules, "__main__" in list(sys.modules))
if __name__ == "__main__":
    print("the end")
