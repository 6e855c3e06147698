"""The program `launch_test`: `python -m launch_testing.launch_test FILE [NAME:=VALUE]...`."""

from __future__ import annotations

import importlib.util
import sys
from collections.abc import Sequence
from pathlib import Path
from types import ModuleType

from launch_testing.loader import LoadTestsFromPythonModule
from launch_testing.test_runner import LaunchTestRunner


def load_python_file_as_module(file: str) -> ModuleType:
    """Return the module in a file. Raises FileNotFoundError, or what the file raises."""
    specification = importlib.util.spec_from_file_location(Path(file).stem.replace(".", "_"), file)
    if specification is None or specification.loader is None or not Path(file).is_file():
        raise FileNotFoundError(f"there is no Python file '{file}'")
    module = importlib.util.module_from_spec(specification)
    sys.modules[module.__name__] = module
    specification.loader.exec_module(module)
    return module


def main(args: Sequence[str] | None = None) -> int:
    """Run the tests of one file, and return 0 if all pass."""
    words = list(sys.argv[1:] if args is None else args)
    files = [word for word in words if ":=" not in word and not word.startswith("-")]
    if len(files) != 1:
        sys.exit("launch_test: expected one file, and arguments of the form NAME:=VALUE")
    try:
        module = load_python_file_as_module(files[0])
        runs = LoadTestsFromPythonModule(module, name=Path(files[0]).stem)
    except (FileNotFoundError, AttributeError) as error:
        sys.exit(f"launch_test: {error}")
    runner = LaunchTestRunner(runs, [word for word in words if ":=" in word], debug="-v" in words)
    try:
        runner.validate()
    except TypeError as error:
        sys.exit(f"launch_test: {files[0]}: {error}")
    return int(not all(result.wasSuccessful() for result in runner.run().values()))


if __name__ == "__main__":
    sys.exit(main())
