"""The page of `ifgen top --web` in headless Chromium, beside a program of two nodes."""

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

webdriver = pytest.importorskip("selenium.webdriver")
from selenium.webdriver.common.by import By  # noqa: E402  # only where selenium is installed
from selenium.webdriver.support.ui import WebDriverWait  # noqa: E402

CHROMIUM, DRIVER = shutil.which("chromium"), shutil.which("chromedriver")
pytestmark = [
    pytest.mark.slow,
    pytest.mark.timeout(180),
    pytest.mark.skipif(not (CHROMIUM and DRIVER), reason="Debian's chromium and chromium-driver are missing"),
]
PATIENCE = 60
# In one go: rows are replaced with each look.
CHOOSE = """
    const rows = [...document.querySelectorAll("#tables tbody tr")];
    const row = rows.find((each) => each.textContent.includes("std_msgs/String"));
    row?.click();
    return row?.dataset.topic;
"""
EXAMPLES = Path(__file__).parents[3] / "examples" / "topics"


@pytest.fixture(scope="module")
def url() -> Iterator[str]:
    """The address of the page; examples/topics runs meanwhile."""
    ifgen = [sys.executable, "-u", "-m", "ifgen"]
    programs = [str(EXAMPLES / "publisher.py"), ":", str(EXAMPLES / "subscriber.py")]
    with own_domain() as domain:
        environment = {
            **os.environ,
            "ROS_DOMAIN_ID": str(domain),
            "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST",
        }
        talking = subprocess.Popen(
            [*ifgen, "run", "--transport", "local", *programs], env=environment, stderr=subprocess.DEVNULL
        )
        showing = subprocess.Popen(
            [*ifgen, "top", "--web", "--port", "0", "--transport", "local", "--period", "0.3"],
            env=environment,
            stdout=subprocess.PIPE,
            text=True,
        )
        try:
            assert showing.stdout is not None
            found = re.search(r"http://127\.0\.0\.1:\d+/", showing.stdout.readline())
            assert found is not None
            yield found[0]
            showing.send_signal(signal.SIGINT)
            assert showing.wait(PATIENCE) == 0
        finally:
            showing.kill()
            talking.send_signal(signal.SIGINT)
            talking.wait(PATIENCE)


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    options = webdriver.ChromeOptions()
    options.binary_location = CHROMIUM or ""
    for argument in ("--headless=new", "--no-sandbox", "--window-size=1280,720"):
        options.add_argument(argument)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    driver = webdriver.Chrome(options, webdriver.ChromeService(DRIVER))
    yield driver
    driver.quit()


@pytest.mark.parametrize("size", [(1280, 720), (390, 844)], ids=["wide", "narrow"])
def test_graph_tables_message_and_plot(browser: Any, url: str, size: tuple[int, int]) -> None:
    metrics = {"width": size[0], "height": size[1], "deviceScaleFactor": 1, "mobile": size[0] < 600}
    browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", metrics)
    browser.get(url)
    wait = WebDriverWait(browser, PATIENCE)

    def texts(selector: str) -> str:
        return " ".join(each.text for each in browser.find_elements(By.CSS_SELECTOR, selector))

    wait.until(lambda _: browser.find_elements(By.CSS_SELECTOR, ".box.node"))
    wait.until(lambda _: " Hz" in texts(".box.topic"))
    browser.find_element(By.CSS_SELECTOR, '[data-view="topics"]').click()
    name = wait.until(lambda _: browser.execute_script(CHOOSE))
    wait.until(lambda _: name in texts("#inspected"))
    wait.until(lambda _: "Hello" in texts("#tree"))
    assert browser.execute_script("return document.documentElement.scrollWidth <= innerWidth")
    assert [entry for entry in browser.get_log("browser") if entry["level"] == "SEVERE"] == []
