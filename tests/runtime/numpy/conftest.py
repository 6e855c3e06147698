"""The classes of the messages that ifgen_runtime.numpy is for: ours, and those that rosidl compiled."""

from __future__ import annotations

from collections.abc import Iterator
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from types import SimpleNamespace

import pytest

from ..support import imported_from

GENERATED = Path(__file__).resolve().parents[3] / "generated"
PACKAGES = ("sensor_msgs", "geometry_msgs", "nav_msgs", "std_msgs", "builtin_interfaces")


@pytest.fixture(scope="module", params=["ours", "compiled"])
def msg(request: pytest.FixtureRequest) -> Iterator[SimpleNamespace]:
    """The classes of sensor_msgs, geometry_msgs, nav_msgs and std_msgs, as attributes."""
    ours = request.param == "ours"
    if not ours and find_spec("rosidl_generator_py") is None:
        pytest.skip("the rosidl wheels are not installed (Linux x86_64 only)")
    with imported_from(GENERATED if ours else None, PACKAGES):
        modules = [import_module(f"{package}.msg") for package in PACKAGES]
        is_ours = [Path(module.__file__ or "").is_relative_to(GENERATED) for module in modules]
        assert set(is_ours) == {ours}
        names = {
            name: getattr(module, name) for module in modules for name in dir(module) if name[0].isupper()
        }
        yield SimpleNamespace(**{name: cls for name, cls in names.items() if isinstance(cls, type)})
