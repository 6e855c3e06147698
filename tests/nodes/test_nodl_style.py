"""The style `nodl`: a subclass that was written for nodl_generator_py runs on what ifgen generates."""

from __future__ import annotations

import ast
from pathlib import Path

import ifgen
import pytest

from tests.nodes.conftest import TRANSPORTS, Ifgen

PROGRAM = Path(__file__).parent / "programs/echoing.py"
QOS = "qos: {history: KEEP_LAST, depth: 1, reliability: RELIABLE}"
DOCUMENT = f"""nodl_version: 2
codegen: {{ifgen: {{style: nodl}}}}
include: [{{ref: "nodl://nodl_common_interfaces/node"}}]
parameters:
  prefix: {{type: string, default_value: "echo: "}}
  colour.r: {{type: double, default_value: 0.5, validation: {{bounds: [0.0, 1.0]}}}}
publishers:
  - {{name: /echo_out, type: std_msgs/msg/String, {QOS}}}
  - {{name: ~/a/b, type: std_msgs/msg/String, {QOS}}}
subscriptions: [{{name: /echo_in, type: std_msgs/msg/String, {QOS}}}]
service_servers: [{{name: ~/go, type: std_srvs/srv/Trigger}}]
service_clients: [{{name: /other/go, type: std_srvs/srv/Trigger}}]
action_servers: [{{name: fib, type: example_interfaces/action/Fibonacci}}]
action_clients: [{{name: /other/fib, type: example_interfaces/action/Fibonacci}}]
"""


@pytest.fixture(scope="module")
def generated(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the generated package, and one node that is managed."""
    folder = tmp_path_factory.mktemp("nodl_style")
    nodl = folder / "in/echo_nodes/nodl"
    nodl.mkdir(parents=True)
    (nodl / "echo.nodl.yaml").write_text(DOCUMENT)
    managed = DOCUMENT.replace("nodl_common_interfaces/node", "nodl_common_interfaces/lifecycle_node")
    (nodl / "managed.nodl.yaml").write_text(managed)
    ifgen.generate(folder / "in", output=folder / "generated")
    return folder


def base_class(generated: Path, name: str) -> ast.ClassDef:
    module = ast.parse((generated / f"generated/echo_nodes/echo_nodes/_{name}_base.py").read_text())
    return next(node for node in module.body if isinstance(node, ast.ClassDef))


def test_only_callbacks_are_abstract(generated: Path) -> None:
    methods = [node for node in base_class(generated, "echo").body if isinstance(node, ast.FunctionDef)]
    abstract = {method.name for method in methods if method.decorator_list}
    assert abstract == {"on_echo_in", "on_go", "execute_fib"}


def test_a_managed_node_makes_everything_at_once(generated: Path) -> None:
    """As nodl_generator_py: only its publishers know of the lifecycle."""
    text = (generated / "generated/echo_nodes/echo_nodes/_managed_base.py").read_text()
    assert "class ManagedBase(LifecycleNode, ABC):" in text
    assert "self.pub_echo_out = self.create_lifecycle_publisher(" in text
    assert "on_configure" not in text


@pytest.mark.slow
@pytest.mark.parametrize("transport", TRANSPORTS)
def test_a_subclass_of_theirs(transport: str, generated: Path, run_ifgen: Ifgen) -> None:
    done = run_ifgen("run", "--transport", transport, PROGRAM, folder=generated)
    expected = "echo: hello 0 True\n0: hello 1 True\nTrue 0.5 echo\nTrue\n1\n"
    assert (done.stdout, done.returncode) == (expected, 0), done.stderr


def test_the_module_of_the_user_is_complete(generated: Path, run_ifgen: Ifgen) -> None:
    done = run_ifgen("check", generated / "in", folder=generated)
    assert done.returncode == 0, done.stdout
    assert "missing-method" not in done.stdout
