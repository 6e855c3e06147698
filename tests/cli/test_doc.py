"""`ifgen doc`: every link leads somewhere, nothing of a definition is taken for HTML, and the search finds it."""

from __future__ import annotations

import re
import shutil
import zlib
from html.parser import HTMLParser
from pathlib import Path

import pytest

from .conftest import Run, write

ROOT = Path(__file__).parents[2]
VOID = frozenset(("meta", "link", "input", "br"))


class Page(HTMLParser):
    """The links, the ids and the open tags of a page."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.links: list[str] = []
        self.ids: set[str] = set()
        self.open: list[str] = []
        self.feed(text)
        self.close()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        values = dict(attrs)
        self.links += [value for name in ("href", "src") if (value := values.get(name))]
        if (id_ := values.get("id")) is not None:
            assert id_ not in self.ids, id_
            self.ids.add(id_)
        if tag not in VOID:
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.handle_starttag(tag, attrs)
        if tag not in VOID:
            self.open.pop()


def dead_links(site: Path) -> list[str]:
    """The links that lead nowhere."""
    pages = {path.resolve(): Page(path.read_text()) for path in site.rglob("*.html")}
    dead: list[str] = []
    for path, page in pages.items():
        assert page.open == [], path
        for link in page.links:
            address, _, place = link.partition("#")
            target = (path.parent / address).resolve() if address else path
            if not target.is_file() or (place and place not in pages[target].ids):
                dead.append(f"{path.relative_to(site.resolve())}: {link}")
    return dead


def test_the_bundled_packages(ifgen: Run, tmp_path: Path) -> None:
    names = ("std_msgs", "geometry_msgs", "sensor_msgs", "nav_msgs", "gait_planner", "builtin_interfaces")
    done = ifgen("doc", *(ROOT / "interfaces" / name for name in names))
    assert done.code == 0, done.err
    site = tmp_path / "site"
    assert dead_links(site) == []
    imu = (site / "sensor_msgs/msg/Imu.html").read_text()
    assert (
        '<a href="../../geometry_msgs/msg/Quaternion.html"><code>geometry_msgs/Quaternion</code></a>' in imu
    )
    assert "rad/s" in imu and "RIHS01_" in imu
    assert "gait_planner" in (site / "geometry_msgs/msg/Twist.html").read_text()
    again = ifgen("doc", *(ROOT / "interfaces" / name for name in names))
    assert "site: 0 files written, " in again.out


def test_texts_are_texts(ifgen: Run, tmp_path: Path) -> None:
    write(
        tmp_path / "demo_msgs/msg/Odd.msg",
        "# <script>alert(1)</script> & \"quoted\"\nstring a '<b>'  # </td></table> [m]\nstring C=</code>\n",
    )
    assert ifgen("doc", "demo_msgs", "--title", "<i>").code == 0
    page = (tmp_path / "site/demo_msgs/msg/Odd.html").read_text()
    assert Page(page).open == []
    assert "<script>alert" not in page and "</td></table> " not in page and "<i>" not in page
    assert "&lt;script&gt;alert(1)&lt;/script&gt; &amp; &quot;quoted&quot;" in page


def test_the_inventory(ifgen: Run, demo_msgs: Path, tmp_path: Path) -> None:
    assert ifgen("doc", demo_msgs, "--title", "Demo", "--version", "1.2").code == 0
    data = (tmp_path / "site/objects.inv").read_bytes()
    head, lines = data.split(b"zlib.\n", 1)
    assert head.startswith(b"# Sphinx inventory version 2\n# Project: Demo\n# Version: 1.2\n")
    found = zlib.decompress(lines).decode().splitlines()
    assert "demo_msgs.msg.Pose py:class 1 demo_msgs/msg/Pose.html -" in found
    assert "demo_msgs.msg.Pose.x py:attribute 1 demo_msgs/msg/Pose.html#message-x -" in found
    assert "demo_msgs.srv.Move_Response.ok py:attribute 1 demo_msgs/srv/Move.html#response-ok -" in found


def test_own_templates(ifgen: Run, demo_msgs: Path, tmp_path: Path) -> None:
    own = '{% extends "html/package.html.j2" %}{% block additions %}<p>ours</p>{% endblock %}'
    write(tmp_path / "mine/package.html.j2", own)
    assert ifgen("doc", demo_msgs, "--templates", "mine").code == 0
    page = (tmp_path / "site/demo_msgs/index.html").read_text()
    assert "<p>ours</p>" in page and "<h1>demo_msgs</h1>" in page


@pytest.mark.slow
@pytest.mark.skipif(shutil.which("chromium") is None, reason="Chromium is not installed")
def test_the_search(ifgen: Run, demo_msgs: Path, tmp_path: Path) -> None:
    """From a folder, without a server: what is typed finds types and fields, the nearest first."""
    import subprocess

    assert ifgen("doc", demo_msgs).code == 0
    page = tmp_path / "site/index.html"
    typed = "<script>search.value = 'pose'; search.dispatchEvent(new Event('input'));</script></body>"
    page.write_text(page.read_text().replace("</body>", typed))
    shown = subprocess.run(
        ["chromium", "--headless", "--no-sandbox", "--disable-gpu", "--dump-dom", page.as_uri()],
        capture_output=True,
        text=True,
        timeout=60,
        check=True,
    ).stdout
    found = re.findall(r'<li><a href="([^"]+)">([^<]+)<small>', shown)
    assert found[0] == ("demo_msgs/msg/Pose.html", "demo_msgs/msg/Pose")
    assert ("demo_msgs/msg/Pose.html#message-x", "Pose.x") in found
