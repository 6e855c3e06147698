"""Strict type checkers on a project of somebody who installed the wheels, by what `ifgen paths` tells to paste."""

from __future__ import annotations

from pathlib import Path

import pytest

from .support import ROOT, attempt, environment, run

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(not (ROOT / "pyproject.toml").exists(), reason="no checkout"),
]

FILES = {
    "pyproject.toml": '[tool.ifgen]\npaths = ["interfaces"]\n\n',
    "interfaces/shop_msgs/srv/Sell.srv": "string what\nfloat64 price 0.1\n---\nbool sold\n",
    "interfaces/shop_msgs/msg/Shelf.msg": "std_msgs/Header header\nstring[] goods\n",
    "interfaces/till/nodl/till.nodl.yaml": (
        "nodl_version: 2\n"
        "service_servers:\n"
        "  - {name: sell, type: shop_msgs/srv/Sell}\n"
        "subscriptions:\n"
        "  - {name: shelf, type: shop_msgs/msg/Shelf, qos: {history: KEEP_LAST, depth: 10, reliability: RELIABLE}}\n"
    ),
    "app.py": (
        "from __future__ import annotations\n"
        "\n"
        "from shop_msgs.msg import Shelf\n"
        "from shop_msgs.srv import Sell\n"
        "from till._till_base import TillBase\n"
        "\n"
        "\n"
        "class Till(TillBase):\n"
        "    def on_shelf(self, message: Shelf) -> None:\n"
        "        print(message.header.stamp.sec, message.goods)\n"
        "\n"
        "    def handle_sell(self, request: Sell.Request, response: Sell.Response) -> Sell.Response:\n"
        "        response.sold = request.price > 0.1\n"
        "        return response\n"
        "\n"
        "    async def buy(self) -> bool:\n"
        "        client = self.create_client(Sell, 'sell')\n"
        "        return (await client.call_async(Sell.Request(what='tea'))).sold\n"
    ),
}
MISTAKE = "\n\ndef wrong(till: Till) -> None:\n    till.create_client(Sell, 'sell').call_async(Shelf())\n"


def test_mypy_and_pyright_far_from_the_repository(wheels: tuple[Path, Path], tmp_path: Path) -> None:
    python = environment(tmp_path / "venv", *wheels)
    ifgen = python.with_name("ifgen")
    project = tmp_path / "project"
    for name, text in FILES.items():
        (project / name).parent.mkdir(parents=True, exist_ok=True)
        (project / name).write_text(text)
    run(ifgen, "generate", cwd=project)
    run(ifgen, "typings", cwd=project)
    pasted = [run(ifgen, "paths", "--format", checker, cwd=project) for checker in ("mypy", "pyright")]
    strict = 'typeCheckingMode = "strict"\ninclude = ["app.py"]\n'
    (project / "pyproject.toml").write_text(
        f"{FILES['pyproject.toml']}{pasted[0]}strict = true\n{pasted[1]}{strict}"
    )
    checkers = [
        (python, "-m", "mypy", "app.py"),
        (python, "-m", "pyright", "--pythonpath", python),
    ]
    for checker in checkers:
        run(*checker, cwd=project, limit=240)
    (project / "app.py").write_text(FILES["app.py"] + MISTAKE)
    for checker in checkers:
        refused = attempt(*checker, cwd=project, limit=240)
        assert refused.returncode == 1, refused.stderr
        assert "Shelf" in refused.stdout and "Sell_Request" in refused.stdout
