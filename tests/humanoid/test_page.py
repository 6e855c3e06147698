"""The page of `ifgen demo --web`, in headless Chromium, where a visitor plays with the robot."""

from __future__ import annotations

import contextlib
import re
import shutil
import signal
import subprocess
import sys
from collections.abc import Iterator

import pytest

webdriver = pytest.importorskip("selenium.webdriver")
from selenium.webdriver.common.action_chains import ActionChains  # noqa: E402
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
    """The address of the page of a demo without a scenario."""
    command = [sys.executable, "-u", "-m", "ifgen", "demo", "--web", "--port", "0", "--idle"]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    assert process.stdout is not None
    try:
        for line in process.stdout:
            if found := re.search(r"http://127\.0\.0\.1:\d+/\S+", line):
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


def test_it_shows_the_robot_and_does_what_a_visitor_wants(browser: webdriver.Chrome, url: str) -> None:
    browser.get(url)
    wait = WebDriverWait(browser, PATIENCE)

    def text(selector: str) -> str:
        return str(browser.find_element(By.CSS_SELECTOR, selector).get_attribute("textContent"))

    def press(selector: str) -> None:
        browser.find_element(By.CSS_SELECTOR, selector).click()

    wait.until(lambda _: text("#mode") == "standing")
    wait.until(lambda _: _drawn(browser))
    press("[data-tab=topics]")
    for topic in ("/joint_states", "/footsteps/upcoming", "/gait_state"):
        wait.until(lambda _, topic=topic: topic in text("#topics"))
    press("[data-tab=nodes]")
    wait.until(lambda _: "whole_body_controller" in text("#nodes"))
    press("[data-tab=control]")

    # Below the robot there is floor.
    stage = browser.find_element(By.ID, "robot")
    ActionChains(browser).move_to_element_with_offset(
        stage, 0, stage.size["height"] // 2 - 60
    ).click().perform()
    wait.until(lambda _: "walking to (" in text("#toast"))
    wait.until(lambda _: "m left" in text("#goals"))
    wait.until(lambda _: text("#mode") == "walking")
    press("#cancel")
    wait.until(lambda _: "walk canceled" in text("#goals"))

    browser.find_element(By.NAME, "words").send_keys("fly\n")
    wait.until(lambda _: "Refused: 'fly' is not a task" in text("#toast"))
    press("#pause")
    wait.until(lambda _: text("#pause") == "Go on")
    press("#restart")
    wait.until(lambda _: float(text("#time").split()[0]) < 1)
    wait.until(lambda _: text("#mode") == "standing")
    assert [entry for entry in browser.get_log("browser") if entry["level"] == "SEVERE"] == []


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
