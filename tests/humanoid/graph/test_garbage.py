"""Garbage on the topics, services and actions of every node: they refuse it and say so, and the robot still walks."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, NamedTuple

import pytest
from action_msgs.msg import GoalStatus
from humanoid.data import Mode
from humanoid.robot.model import HumanoidModel, load
from humanoid.show import crew
from humanoid.show.audience import Audience
from humanoid.show.director import Director
from humanoid.show.recorder import Recorder
from humanoid_interfaces.action import PerformDance, WalkTo
from rclpy.action import ActionClient
from rclpy.node import Node
from rclpy.qos import QoSProfile
from rclpy.task import Future
from std_srvs.srv import SetBool

from tests.humanoid.graph.garbage import Draw
from tests.humanoid.graph.robot import Robot, walk

MakeRobot = Callable[..., Robot]
# A bad reading can displace a good one from a queue of one, and then nobody answers the tick.
PATIENCE = {"humanoid_simulator": {"patience": 0.1, "ground_truth": True}}
FEW = (
    "/joint_encoders",
    "/imu/data",
    "/gait_state",
    "/footsteps/upcoming",
    "/servos/standby",
    "/joint_commands",
)
NOT_OURS = {"/clock", "/parameter_events"}  # rclpy itself subscribes
ACTIONS = {"/walk_to": WalkTo, "/perform_dance": PerformDance}
SWITCHES = ("/humanoid_simulator/pause", "/joint_controller/hold", "/emergency_stop/set")
STARTS_AGAIN = "/humanoid_simulator/reset"


class Topic(NamedTuple):
    """What subscribers of a topic expect."""

    kind: type[Any]
    qos: QoSProfile


class Victim:
    """A robot with everything that runs in the demo."""

    def __init__(self, robot: Robot, executor: Any, folder: Path, model: HumanoidModel) -> None:
        self.robot, self._executor = robot, executor
        shown = (Director(lambda what: None), Audience(), Recorder(model, folder / "robot.gif"))
        self.nodes: list[Node] = [*robot.nodes.values(), *shown]
        for node in shown:
            executor.add_node(node)
        self._shown = shown
        self.heard: dict[str, Any] = {}
        for name, topic in self.topics().items():
            qos = QoSProfile(depth=1, durability=topic.qos.durability, reliability=topic.qos.reliability)
            robot.listen(topic.kind, name, lambda message, name=name: self.heard.update({name: message}), qos)
        robot.until(lambda: robot.mode is Mode.STANDING)

    def topics(self) -> dict[str, Topic]:
        """The topics that any node subscribes to, by what the nodes themselves say."""
        found = {
            subscription.topic_name: Topic(subscription.msg_type, subscription.qos_profile)
            for node in self.nodes
            for subscription in node.subscriptions
        }
        return {name: topic for name, topic in sorted(found.items()) if name not in NOT_OURS}

    def services(self) -> dict[str, type[Any]]:
        """The services that the robot's descriptions name."""
        own = {
            node.resolve_service_name(service.srv_name): service.srv_type
            for node in self.robot.nodes.values()
            for service in node.services
        }
        return {
            name: kind for name, kind in own.items() if kind.__module__.startswith(("humanoid", "std_srvs"))
        }

    def attack(self, name: str, topic: Topic) -> None:
        """Publish garbage of each sort."""
        qos = QoSProfile(depth=10, durability=topic.qos.durability, reliability=topic.qos.reliability)
        qos.deadline = topic.qos.deadline
        publisher = self.robot.tester.create_publisher(topic.kind, name, qos)
        for _, message in Draw(name).messages(topic.kind, self.heard.get(name), self.robot.physics.stamp):
            publisher.publish(message)
            self.robot.run(0.012)
        self.robot.tester.destroy_publisher(publisher)

    def ask(self, kind: type[Any], name: str, send: Callable[[Any], Future]) -> None:
        """Send garbage of each sort in requests or goals, each of which is answered."""
        for sort, request in Draw(name).messages(kind, None, self.robot.physics.stamp):
            answered = send(request)
            self.robot.until(answered.done)
            assert answered.exception() is None, (name, sort)
            self.calm()

    def calm(self) -> None:
        """Undo what garbage may ask for by chance."""
        for name in SWITCHES:
            self.robot.call(SetBool, name, SetBool.Request(data=False))

    def walks(self, after: str) -> None:
        """The robot walks a step ahead."""
        robot = self.robot
        robot.run(1.5)  # readings of a node that was confused are good for a second again
        self.calm()
        end = robot.now + 4.0
        robot.until(lambda: robot.mode is Mode.STANDING or robot.now > end)
        x, y, yaw = robot.physics.sole_truth().centre.tolist()
        handle = robot.send(walk(x + 0.1, y, yaw))
        assert handle.accepted, (after, robot.log[-4:])
        status, result = robot.result(handle)
        assert (status, robot.fell) == (GoalStatus.STATUS_SUCCEEDED, False), (after, result.message)

    def close(self) -> None:
        """End what the robot does not."""
        for node in self._shown:
            self._executor.remove_node(node)
            node.destroy_node()


@pytest.fixture
def victim(make_robot: MakeRobot, ros_executor: Any, tmp_path: Path) -> Iterator[Victim]:
    found = Victim(make_robot(*crew.all_nodes(), **PATIENCE), ros_executor, tmp_path, load())
    yield found
    found.close()


def test_garbage_on_a_few_topics(victim: Victim) -> None:
    topics, robot = victim.topics(), victim.robot
    encoders = topics["/joint_encoders"]
    poison = encoders.kind(name=["x"], position=[0.0])
    robot.publisher(encoders.kind, "/joint_encoders", encoders.qos)(poison)
    robot.expect("joint_state_publisher", "/joint_encoders: the robot has no joint 'x'")
    assert len(victim.heard["/joint_states"].name) == 29
    for name in FEW:
        victim.attack(name, topics[name])
    victim.walks("garbage")
    for node, words in (
        ("joint_state_publisher", "reports refused ("),
        ("imu_fusion", "readings refused ("),
        ("navigation_action_server", "readings refused ("),
        ("whole_body_controller", "plans refused ("),
        ("humanoid_simulator", "set-points refused ("),
    ):
        assert robot.said(node, words), node


@pytest.mark.slow
def test_garbage_on_all_topics(victim: Victim) -> None:
    topics = victim.topics()
    assert len(topics) > 25
    for number, (name, topic) in enumerate(topics.items(), 1):
        victim.attack(name, topic)
        if number % 6 == 0 or number == len(topics):
            victim.walks(f"garbage up to {name}")
    assert all(text.isprintable() for _, text in victim.robot.log)


@pytest.mark.slow
def test_garbage_in_all_requests_and_goals(victim: Victim) -> None:
    robot = victim.robot
    for name, kind in victim.services().items():
        if name == STARTS_AGAIN:
            continue
        client = robot.tester.create_client(kind, name)
        robot.until(client.service_is_ready)
        victim.ask(kind.Request, name, client.call_async)
        robot.tester.destroy_client(client)
    victim.walks("requests")
    for name, action in ACTIONS.items():
        goals = ActionClient(robot.tester, action, name)
        robot.until(goals.server_is_ready)
        victim.ask(action.Goal, name, goals.send_goal_async)
        victim.walks(name)
