"""The examples of docs/dynamic.md run, and print what the page says they are."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PAGE = (ROOT / "docs/dynamic.md").read_text()


def ifgen(folder: Path, *arguments: str) -> str:
    command = [sys.executable, "-m", "ifgen", *arguments]
    ran = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=60, check=False)
    assert ran.returncode == 0, ran.stderr
    return ran.stdout


def test_the_examples_run(tmp_path: Path) -> None:
    topic, service, described, text = re.findall(r"^```python\n(.*?)^```$", PAGE, re.MULTILINE | re.DOTALL)
    (tmp_path / "Point.json").write_text(ifgen(tmp_path, "show", "--json", "geometry_msgs/msg/Point"))
    (tmp_path / "described.py").write_text(described)
    (tmp_path / "text.py").write_text(text)
    (tmp_path / "topic.py").write_text(topic.replace("rclpy.spin(node)", "rclpy.spin_once(node)"))
    (tmp_path / "odometry.py").write_text(
        "import rclpy\nfrom nav_msgs.msg import Odometry\nrclpy.init()\nnode = rclpy.create_node('wheels')\n"
        "odometry = node.create_publisher(Odometry, '/odometry', 10)\n"
        "node.create_timer(0.1, lambda: odometry.publish(Odometry(child_frame_id='base')))\nrclpy.spin(node)\n"
    )
    (tmp_path / "service.py").write_text(service)
    (tmp_path / "add.py").write_text(
        "import rclpy\nfrom example_interfaces.srv import AddTwoInts\nrclpy.init()\n"
        "node = rclpy.create_node('adder')\ndef add(asked, answer):\n    answer.sum = asked.a + asked.b\n"
        "    return answer\nnode.create_service(AddTwoInts, '/add', add)\nrclpy.spin(node)\n"
    )
    run = ("run", "--transport", "local")
    hash_ = ifgen(tmp_path, "hash", "geometry_msgs/msg/Point").split()[1]
    assert ifgen(tmp_path, *run, "described.py") == f"geometry_msgs.msg.Point(x=0.1, y=0.0, z=0.0) {hash_}\n"
    assert ifgen(tmp_path, *run, "text.py").splitlines() == [
        "my_msgs.msg.Speed(value=0.1) 1",
        "my_msgs.msg.Path(points=[], speed=my_msgs.msg.Speed(value=0.0))",
    ]
    first, second, *_ = ifgen(tmp_path, *run, "odometry.py", ":", "topic.py").splitlines()
    assert re.fullmatch(r"nav_msgs/msg/Odometry RIHS01_\w{64} from /wheels", first)
    assert "child_frame_id='base'" in second
    assert ifgen(tmp_path, *run, "add.py", ":", "service.py").splitlines()[0] == (
        "example_interfaces.srv.AddTwoInts_Response(sum=3)"
    )
