"""examples/templates: each is generated in a copy, and its output is linted, parsed and run."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from html.parser import HTMLParser
from pathlib import Path

import pytest

from ..conftest import Run

ROOT = Path(__file__).parents[3]


@pytest.fixture(params=["company", "pydantic", "reference"])
def example(request: pytest.FixtureRequest, tmp_path: Path, ifgen: Run) -> str:
    name: str = request.param
    source = ROOT / "examples/templates" / name
    shutil.copytree(source, tmp_path, dirs_exist_ok=True, ignore=shutil.ignore_patterns("generated"))
    if name != "pydantic":  # which has no templates of its own
        assert ifgen("templates", "check").out == "templates: no mistakes\n"
    done = ifgen("generate", "--no-tests")
    assert (done.code, done.err) == (0, "")
    assert ifgen("generate", "--no-tests", "--check").code == 0
    return name


CHECKS = {
    "company": """
from acme_msgs.msg import Battery
from acme_msgs.srv import Dock
from acme_support.messages import AcmeMessage
import ifgen_runtime, copy, pickle
battery = Battery(voltage=24.5, cells=[4.0, 4.5])
assert battery.summary() == "voltage=24.5, charge=1.0, cells=<2>, state=0", battery.summary()
assert Dock.Response().summary().startswith("docked=False, battery=(voltage=0.0")
assert all(issubclass(c, AcmeMessage) for c in (Battery, Dock.Request, Dock.Response, Dock.Event))
assert not hasattr(battery, "__dict__")
data = ifgen_runtime.serialize(battery)
assert ifgen_runtime.deserialize(data, Battery) == battery == copy.deepcopy(battery) == pickle.loads(pickle.dumps(battery))
""",
    "pydantic": """
import json
from message_models.survey_msgs import FindLandmarks_Request, FindLandmarks_Response, Landmark
from survey_msgs.msg import Landmark as Message
from survey_msgs.srv import FindLandmarks
from pydantic import ValidationError
assert Landmark().to_message() == Message()
assert Landmark.from_message(Message()) == Landmark()
full = Landmark(kind=2, label="exit", position={"x": 1.5}, distances=[1.0], tags=["a"], flags=7, outline=[{"z": 2.0}], window=[1, 2])
message = full.to_message()
assert (message.position.x, message.flags, list(message.distances), message.outline[0].z) == (1.5, b"\\x07", [1.0], 2.0)
assert Landmark.from_message(message) == full == Landmark.model_validate_json(full.model_dump_json())
assert FindLandmarks_Request(radius=2).to_message() == FindLandmarks.Request(radius=2.0)
assert FindLandmarks_Response(landmarks=[full]).to_message().landmarks == [message]
assert Landmark.KIND_SIGN == Message.KIND_SIGN
for wrong in ({"kind": 256}, {"kind": -1}, {"label": "x" * 17}, {"distances": [0.0] * 5}, {"window": [1]}, {"covariance": []},
              {"tags": ["x" * 9]}, {"flags": 256}, {"nonsense": 1}, {"window": [1, 128]}):
    try:
        Landmark(**wrong)
    except ValidationError:
        continue
    raise AssertionError(wrong)
bounds = {}
def limits(name, found):
    words = ("minimum", "maximum", "maxLength", "minItems", "maxItems")
    bounds.setdefault(name, []).append({w: found[w] for w in words if w in found})
    if "items" in found:
        limits(name + "[]", found["items"])
ours = json.load(open("generated/schemas/survey_msgs/msg/Landmark.json"))
for schema in (ours["$defs"]["survey_msgs.msg.Landmark"], Landmark.model_json_schema()):
    for name, found in schema["properties"].items():
        limits(name, found)
assert all(len(both) == 2 and both[0] == both[1] for both in bounds.values()), bounds
assert bounds["window[]"][0] == {"minimum": -128, "maximum": 127}
""",
    "reference": "",
}


def test_what_comes_out_runs_and_is_clean(example: str, tmp_path: Path) -> None:
    environment = {
        **os.environ,
        "PYTHONPATH": os.pathsep.join(["generated", ".", str(ROOT / "codegen"), str(ROOT / "generated")]),
    }
    subprocess.run([sys.executable, "-c", CHECKS[example]], env=environment, check=True, timeout=60)
    made = {"company": "acme_msgs", "pydantic": "message_models", "reference": "patrol_msgs"}[example]
    lint = ["ruff", "check", "--isolated", "--select", "E,F,B,UP", "--ignore", "E501", f"generated/{made}"]
    subprocess.run(
        [sys.executable, "-m", *lint, *(["filters.py"] if Path("filters.py").exists() else [])], check=True
    )
    for path in Path("generated").rglob("*.json"):
        json.loads(path.read_text())


class _Page(HTMLParser):
    """Collects ids, links and text; reports tags that do not match."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.ids: list[str] = []
        self.links: list[str] = []
        self.words: list[str] = []
        self._open: list[str] = []
        self.feed(text)
        assert self._open == []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        found = dict(attrs)
        self.ids += filter(None, [found.get("id")])
        self.links += filter(None, [found.get("href")])
        if tag != "meta" and not (self.get_starttag_text() or "").endswith("/>"):
            self._open.append(tag)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.handle_starttag(tag, attrs)

    def handle_endtag(self, tag: str) -> None:
        assert self._open.pop() == tag

    def handle_data(self, data: str) -> None:
        self.words.append(data)


@pytest.mark.parametrize("example", ["reference"], indirect=True)
def test_the_reference_is_whole(example: str) -> None:
    page = _Page(Path("generated/reference/index.html").read_text())
    sections = {"patrol-msgs-msg-Sighting", "patrol-msgs-srv-Silence", "patrol-msgs-action-Patrol"}
    assert sections | {"watcher", "alarm", "patroller"} <= set(page.ids)
    assert len(page.ids) == len(set(page.ids))
    assert {link.removeprefix("#") for link in page.links} <= set(page.ids), "no link leads nowhere"
    assert 'for people: "<b>" is no markup here' in " ".join(page.words)
    index = Path("generated/reference/index.md").read_text()
    assert "    watcher --> point2\n" in index
    assert '    point2(["/sightings<br>patrol_msgs/msg/Sighting"])\n' in index
    folder = Path("generated/reference")
    for path in folder.rglob("*.md"):
        text = path.read_text()
        assert "None" not in text
        for row in (line for line in text.splitlines() if line.startswith("|")):
            assert row.replace("\\|", "").endswith("|")
    assert (
        "| `threshold` | `double` | `0.6` | bounds\\<\\>: \\[0.0, 1.0\\] |"
        in (folder / "nodes/patrol_robot.watcher.md").read_text()
    )
    assert "last 1, best effort" in (folder / "nodes/patrol_robot.watcher.md").read_text()


@pytest.mark.slow
@pytest.mark.parametrize("example", ["company", "pydantic"], indirect=True)
def test_types_hold(example: str) -> None:
    package = {"company": "acme_msgs", "pydantic": "message_models.survey_msgs"}[example]
    path = os.pathsep.join(["generated", ".", str(ROOT / "codegen"), str(ROOT / "generated")])
    subprocess.run(
        [sys.executable, "-m", "mypy", "--strict", "-p", package],
        env={**os.environ, "MYPYPATH": path},
        check=True,
        timeout=110,
    )
