"""Generated classes behave like rosidl's: one program, run with ours and with rosidl's, prints the same.

rosidl's classes are those of the wheels, and those that its own generator makes from `form_msgs`, which has every
type in every form. Deliberate differences are left out of the program and tested in tests/generator_py.
"""

from __future__ import annotations

import difflib
import json
import os
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

HERE = Path(__file__).parent
ROOT = HERE.parent.parent
WHEELS = [
    *(
        "action_msgs",
        "actionlib_msgs",
        "builtin_interfaces",
        "diagnostic_msgs",
        "geometry_msgs",
        "lifecycle_msgs",
    ),
    *("nav_msgs", "rcl_interfaces", "rosgraph_msgs", "sensor_msgs", "service_msgs", "shape_msgs", "std_msgs"),
    *("std_srvs", "stereo_msgs", "test_msgs", "trajectory_msgs", "type_description_interfaces"),
    *("rmw_dds_common", "unique_identifier_msgs", "visualization_msgs"),
]
# An array that Python or numpy cannot convert for rosidl's setter, while no check refuses it.
REFUSED_ARRAY = re.compile(r" of an array -> ! (?!AssertionError)")
SHARE = Path(sys.prefix) / "share"

pytest.importorskip("rosidl_generator_py", reason="the rosidl wheels are not installed (Linux x86_64 only)")


@pytest.fixture(scope="module")
def rosidl_classes(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with form_msgs as rosidl generates it."""
    folder = tmp_path_factory.mktemp("rosidl")
    subprocess.run(
        [sys.executable, str(HERE / "rosidl_generate.py"), str(HERE / "form_msgs"), str(folder)], check=True
    )
    return folder


@pytest.fixture(scope="module")
def our_classes(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with form_msgs and the packages of the wheels as ifgen generates them from the wheels' definitions."""
    import ifgen

    folder = tmp_path_factory.mktemp("ours")
    ifgen.generate(HERE / "form_msgs", *(SHARE / name for name in WHEELS), output=folder)
    return folder


def transcript(path: list[Path], arguments: list[str], check_fields: str) -> dict[str, list[str]]:
    """The transcript of the classes found on `path`."""
    environment = {**os.environ, "ROS_PYTHON_CHECK_FIELDS": check_fields}
    environment["PYTHONWARNINGS"] = "ignore"  # numpy's, about values that do not fit
    environment["PYTHONPATH"] = os.pathsep.join(map(str, path))
    command = [sys.executable, str(HERE / "class_transcript.py"), *arguments]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=110, check=False)
    assert done.returncode == 0, done.stderr[-3000:]
    return json.loads(done.stdout)


def differences(ours: dict[str, Any], rosidl: dict[str, Any]) -> list[str]:
    """The lines that differ, of all classes."""
    found = [f"only one has {name}" for name in ours.keys() ^ rosidl.keys()]
    for name in ours.keys() & rosidl.keys():
        pairs = list(zip(rosidl[name], ours[name], strict=True))
        lines = [pair for pair in pairs if not REFUSED_ARRAY.search(pair[0])]
        if any(theirs != our for theirs, our in lines):
            theirs, our = zip(*lines, strict=True)
            diff = difflib.unified_diff(theirs, our, "rosidl", f"ours: {name}", lineterm="", n=0)
            found += [line[:600] for line in diff]
    return found


@pytest.mark.parametrize(
    ("arguments", "check_fields"),
    [
        pytest.param(["form_msgs", "--thorough"], "", id="every form", marks=pytest.mark.slow),
        pytest.param(["form_msgs"], "1", id="checks by default"),
        pytest.param(["form_msgs"], "true", id="no checks by default", marks=pytest.mark.slow),
        pytest.param(WHEELS, "", id="wheels", marks=pytest.mark.slow),
    ],
)
def test_classes_do_what_rosidls_do(
    rosidl_classes: Path, our_classes: Path, arguments: list[str], check_fields: str
) -> None:
    rosidl = transcript([rosidl_classes], arguments, check_fields)
    ours = transcript([our_classes, ROOT / "codegen"], arguments, check_fields)
    found = differences(ours, rosidl)
    assert not found, "\n".join(found[:80])
    assert sum(map(len, ours.values())) > 1000
