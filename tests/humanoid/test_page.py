"""The page of `ifgen demo --web`, in headless Chromium, while the robot walks."""

from __future__ import annotations

import contextlib
import re
import shutil
import signal
import subprocess
import sys
import urllib.error
import urllib.request
from collections.abc import Iterator

import pytest

webdriver = pytest.importorskip("selenium.webdriver")
from selenium.webdriver.common.by import By  # noqa: E402  # only where selenium is installed
from selenium.webdriver.support.ui import WebDriverWait  # noqa: E402

CHROMIUM, DRIVER = shutil.which("chromium"), shutil.which("chromedriver")
pytestmark = [
    pytest.mark.slow,
    pytest.mark.timeout(300),
    pytest.mark.skipif(not (CHROMIUM and DRIVER), reason="Debian's chromium and chromium-driver are missing"),
]
PATIENCE = 120


@pytest.fixture(scope="module")
def url() -> Iterator[str]:
    """The address of the page of a walking demo."""
    command = [sys.executable, "-u", "-m", "ifgen", "demo", "--web", "--port", "0", "--scenario", "walk"]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    assert process.stdout is not None
    try:
        for line in process.stdout:
            if found := re.search(r"http://127\.0\.0\.1:\d+/", line):
                yield found[0]
                break
    finally:
        process.send_signal(signal.SIGINT)
        with contextlib.suppress(subprocess.TimeoutExpired):
            process.wait(20)
        process.kill()


@pytest.fixture(scope="module")
def browser() -> Iterator[webdriver.Chrome]:
    options = webdriver.ChromeOptions()
    options.binary_location = CHROMIUM or ""
    for argument in ("--headless=new", "--no-sandbox", "--use-angle=swiftshader", "--window-size=1400,1000"):
        options.add_argument(argument)
    options.add_argument("--enable-unsafe-swiftshader")
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    driver = webdriver.Chrome(options, webdriver.ChromeService(DRIVER))
    yield driver
    driver.quit()


def test_it_shows_the_robot_and_cancels_its_goal(browser: webdriver.Chrome, url: str) -> None:
    browser.get(url)
    wait = WebDriverWait(browser, PATIENCE)

    def text(selector: str) -> str:
        return str(browser.find_element(By.CSS_SELECTOR, selector).text)

    wait.until(lambda _: text("#mode") == "walking")
    wait.until(lambda _: "m left" in text("#goals"))
    for topic in ("/joint_states", "/footsteps/upcoming", "/gait_state"):
        wait.until(lambda _, topic=topic: topic in text("#topics"))
    wait.until(lambda _: "/whole_body_controller" in text("#drawing"))
    wait.until(lambda _: _drawn(browser))
    cancel = browser.find_element(By.ID, "cancel")
    wait.until(lambda _: cancel.is_enabled())
    cancel.click()
    wait.until(lambda _: "canceled" in text("#goals"))
    assert [entry for entry in browser.get_log("browser") if entry["level"] == "SEVERE"] == []


def test_others_cannot_press_its_buttons(url: str) -> None:
    for headers in ({}, {"X-Humanoid": "1", "Host": "evil.example"}):
        request = urllib.request.Request(f"{url}stop", method="POST", headers=headers)
        with pytest.raises(urllib.error.HTTPError) as refused:
            urllib.request.urlopen(request, timeout=10)
        assert refused.value.code == 403


def _drawn(browser: webdriver.Chrome) -> bool:
    """Whether the canvas shows more than a background."""
    script = """
        const canvas = document.getElementById("robot");
        const copy = document.createElement("canvas");
        [copy.width, copy.height] = [64, 64];
        return new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => {
          const context = copy.getContext("2d");
          context.drawImage(canvas, 0, 0, 64, 64);
          const seen = new Set(new Uint32Array(context.getImageData(0, 0, 64, 64).data.buffer));
          done(seen.size);
        })));
    """
    return int(browser.execute_script(script)) > 20
