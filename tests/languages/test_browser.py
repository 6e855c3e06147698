"""examples/languages/browser: TypeScript of ours and a Python node talk over a WebSocket, in Node and in Chromium."""

from __future__ import annotations

import os
import re
import shutil
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from ifgen_pytest.domains import own_domain

from ..conformance.support import TYPESCRIPT, node_modules, tool
from .support import ROOT, run

pytestmark = [pytest.mark.slow, pytest.mark.timeout(280)]
pytest.importorskip("websockets")

SOURCE = ROOT / "examples/languages/browser"
IFGEN = Path(sys.executable).with_name("ifgen")
CHROMIUM, DRIVER = shutil.which("chromium"), shutil.which("chromedriver")
PATIENCE = 60


@pytest.fixture(scope="module")
def example(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The example, made as its README says; npm's package comes from where other tests take it."""
    tool("make")
    folder = tmp_path_factory.mktemp("browser") / "example"
    made = shutil.ignore_patterns("generated", "node_modules", "ros", "*.js", "__pycache__")
    shutil.copytree(SOURCE, folder, ignore=made)
    assert f'"typescript": "{TYPESCRIPT["typescript"]}"' in (folder / "package.json").read_text()
    node_modules(folder, TYPESCRIPT)
    (folder / "package-lock.json").unlink(missing_ok=True)
    run(["make", f"IFGEN={IFGEN}", f"PYTHON={sys.executable}"], folder)
    return folder


@pytest.fixture(params=["local", "rclpy"])
def address(request: pytest.FixtureRequest, example: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[str]:
    """The address of the page, while the bridge runs."""
    if request.param == "rclpy":
        pytest.importorskip("rpyutils", reason="real rclpy is not installed")
    monkeypatch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
    with own_domain() as domain:
        monkeypatch.setenv("ROS_DOMAIN_ID", str(domain))
        command = [str(IFGEN), "run", "--transport", request.param, "bridge.py", "0"]
        with subprocess.Popen(command, cwd=example, stdout=subprocess.PIPE, text=True) as bridge:
            try:
                assert bridge.stdout is not None
                found = re.search(r"http://(127\.0\.0\.1:\d+)/", bridge.stdout.readline())
                assert found is not None
                yield found[1]
                bridge.send_signal(signal.SIGINT)
                assert bridge.wait(PATIENCE) == 0
            finally:
                bridge.kill()


def test_in_node(example: Path, address: str) -> None:
    # Built in from version 22 on, and behind this option in 20.
    built_in = run(["node", "-p", "typeof WebSocket"], example).strip() == "function"
    command = ["node", *([] if built_in else ["--experimental-websocket"]), "web/check.js", f"ws://{address}"]
    blocks = re.findall(r"```\n(.*?)```", (example / "README.md").read_text(), re.DOTALL)
    assert run(command, example) == blocks[-1]


@pytest.mark.skipif(not (CHROMIUM and DRIVER), reason="Debian's chromium and chromium-driver are missing")
@pytest.mark.parametrize("address", ["local"], indirect=True)
def test_in_chromium(address: str) -> None:
    webdriver = pytest.importorskip("selenium.webdriver")
    from selenium.webdriver.common.by import By
    from selenium.webdriver.support.ui import WebDriverWait

    options = webdriver.ChromeOptions()
    options.binary_location = CHROMIUM or ""
    for argument in ("--headless=new", "--no-sandbox", "--window-size=800,760"):
        options.add_argument(argument)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    browser: Any = webdriver.Chrome(options, webdriver.ChromeService(DRIVER))
    try:
        browser.get(f"http://{address}/")
        wait = WebDriverWait(browser, PATIENCE)

        def text(of: str) -> str:
            return str(browser.find_element(By.ID, of).text)

        def press(name: str) -> None:
            browser.find_element(By.ID, name).click()

        wait.until(lambda _: text("state").startswith("idle at 0.00 m, 0.00 m"))
        press("drive")
        wait.until(lambda _: text("said") == "succeeded after 2.00 m")
        wait.until(lambda _: " at 2.00 m, 0.00 m" in text("state"))
        assert browser.execute_script("return document.getElementById('progress').value") == 2
        ahead = browser.find_element(By.ID, "ahead")
        webdriver.ActionChains(browser).click_and_hold(ahead).perform()
        wait.until(lambda _: text("state").startswith("driving"))
        webdriver.ActionChains(browser).release().perform()
        wait.until(lambda _: text("state").startswith("idle"))
        pixels = browser.execute_script(
            "const c = document.getElementById('paper');"
            "return [...c.getContext('2d').getImageData(0, 0, c.width, c.height).data]"
        )
        orange = sum(pixels[i : i + 3] == [238, 136, 0] for i in range(0, len(pixels), 4))
        assert orange > 100, "the trail"
        if picture := os.environ.get("SCREENSHOT"):
            browser.save_screenshot(picture)
        press("place")
        wait.until(lambda _: text("said") == "at 0 m, 0 m")
        press("drive")
        press("cancel")
        wait.until(lambda _: text("said").startswith("canceled"))
        assert [entry for entry in browser.get_log("browser") if entry["level"] == "SEVERE"] == []
    finally:
        browser.quit()


def test_pages_of_other_sites_are_refused(address: str) -> None:
    from websockets.exceptions import InvalidStatus
    from websockets.sync.client import connect

    with pytest.raises(InvalidStatus, match="403"):
        connect(f"ws://{address}/", origin="http://example.org")
