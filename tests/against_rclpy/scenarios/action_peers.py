"""Peers that use an action's hidden services and topics themselves, and what the graph shows of them."""

import rclpy
from action_msgs.msg import GoalInfo, GoalStatus
from rclpy.action import (
    ActionClient,
    ActionServer,
    get_action_client_names_and_types_by_node,
    get_action_names_and_types,
    get_action_server_names_and_types_by_node,
)
from rclpy.executors import SingleThreadedExecutor
from rclpy.qos import QoSProfile, ReliabilityPolicy, qos_profile_action_status_default
from rclpy.topic_or_service_is_hidden import topic_or_service_is_hidden
from test_msgs.action import Fibonacci, NestedMessage
from transcript import attempt, until
from unique_identifier_msgs.msg import UUID

IMPL = Fibonacci.Impl


def goal_id(number):
    return UUID(uuid=[number] * 16)


class RawServer:
    """A server made of services and publishers."""

    def __init__(self, node, name):
        self.requests = []
        node.create_service(IMPL.SendGoalService, f"{name}/_action/send_goal", self.on_goal)
        node.create_service(IMPL.CancelGoalService, f"{name}/_action/cancel_goal", self.on_cancel)
        node.create_service(IMPL.GetResultService, f"{name}/_action/get_result", self.on_result)
        self.feedback = node.create_publisher(IMPL.FeedbackMessage, f"{name}/_action/feedback", 10)
        self.status = node.create_publisher(
            IMPL.GoalStatusMessage, f"{name}/_action/status", qos_profile_action_status_default
        )

    def on_goal(self, request, response):
        self.requests.append(f"goal {request.goal.order}")
        response.accepted = request.goal.order != 0
        response.stamp.sec = 77
        return response

    def on_cancel(self, request, response):
        self.requests.append(f"cancel {request.goal_info.goal_id.uuid[0]}")
        response.return_code = 3
        response.goals_canceling = [request.goal_info]
        return response

    def on_result(self, request, response):
        self.requests.append(f"result {request.goal_id.uuid[0]}")
        response.status = GoalStatus.STATUS_ABORTED
        response.result.sequence = [4, 2]
        return response

    def publish_feedback(self, number, *sequence):
        message = IMPL.FeedbackMessage(goal_id=goal_id(number))
        message.feedback.sequence = list(sequence)
        self.feedback.publish(message)

    def publish_status(self, *reports):
        message = IMPL.GoalStatusMessage()
        message.status_list = [
            GoalStatus(goal_info=GoalInfo(goal_id=goal_id(number)), status=status)
            for number, status in reports
        ]
        self.status.publish(message)


def raw_server(node, executor):
    """Our client against a raw server."""
    client = ActionClient(node, Fibonacci, "raw")
    print("before", client.server_is_ready())
    server = RawServer(node, "raw")
    print("found", client.wait_for_server(10.0))

    def finish(future):
        until(future.done, executor)
        return future.result()

    heard = []

    def listen(message):
        heard.append((int(message.goal_id.uuid[0]), list(message.feedback.sequence)))

    until(server.feedback.get_subscription_count)  # a server counts as ready before its feedback is received
    future = client.send_goal_async(Fibonacci.Goal(order=1), listen, goal_id(1))
    server.publish_feedback(1, 9)
    until(lambda: heard, executor)
    print("feedback first", heard)
    handle = finish(future)
    print("goal", handle.accepted, handle.stamp.sec, handle.status, handle.goal_id == goal_id(1))
    other = finish(client.send_goal_async(Fibonacci.Goal(order=2), None, goal_id(2)))
    print("rejected", finish(client.send_goal_async(Fibonacci.Goal(order=0), listen, goal_id(3))).accepted)
    server.publish_feedback(2, 1)
    server.publish_feedback(99, 1)
    server.publish_feedback(1, 2)
    until(lambda: len(heard) == 2, executor)
    print("only its own", heard)
    for reports in (((1, 2),), ((1, 3), (2, 2), (50, 1)), ((1, 5), (2, 2)), ((1, 2), (2, 9))):
        server.publish_status(*reports)
        wanted = dict(reports).get(2, 0)
        until(lambda wanted=wanted: other.status == wanted, executor)
        print("status", handle.status, other.status)
    response = finish(handle.cancel_goal_async())
    print("cancel", response.return_code, len(response.goals_canceling))
    ended = finish(handle.get_result_async())
    print("result", ended.status, ended.result.sequence)
    server.publish_feedback(1, 3)
    ended = finish(other.get_result_async())
    print("no feedback after the result", len(heard), server.requests)

    # A second server: the client receives two answers, takes the first and warns about the other.
    second = RawServer(node, "raw")
    node.create_publisher(IMPL.FeedbackMessage, "unrelated", 1)
    until(lambda: node.count_services("/raw/_action/send_goal") >= 1, executor)
    until(lambda: finish(client.send_goal_async(Fibonacci.Goal(order=7))) and second.requests, executor)
    print("two servers", set(second.requests))
    client.destroy()


def raw_client(node, executor):
    """A raw client against our server."""

    def execute(handle):
        handle.publish_feedback(Fibonacci.Feedback(sequence=[handle.request.order]))
        handle.succeed()
        return Fibonacci.Result(sequence=[handle.request.order * 2])

    held = []
    server = ActionServer(node, Fibonacci, "served", execute, handle_accepted_callback=held.append)
    heard, statuses = [], []
    send = node.create_client(IMPL.SendGoalService, "served/_action/send_goal")
    get = node.create_client(IMPL.GetResultService, "served/_action/get_result")
    node.create_subscription(IMPL.FeedbackMessage, "served/_action/feedback", heard.append, 10)

    def see(message):
        statuses.append([(int(each.goal_info.goal_id.uuid[0]), each.status) for each in message.status_list])

    # Deeper than the default, so that nothing is skipped.
    profile = QoSProfile(depth=20, durability=qos_profile_action_status_default.durability)
    node.create_subscription(IMPL.GoalStatusMessage, "served/_action/status", see, profile)
    for client in (send, get):
        client.wait_for_service(10.0)
    until(lambda: node.count_subscribers("/served/_action/status") == 1, executor)

    def finish(future):
        until(future.done, executor)
        return future.result()

    request = IMPL.SendGoalService.Request(goal_id=goal_id(5), goal=Fibonacci.Goal(order=21))
    response = finish(send.call_async(request))
    print("goal", response.accepted, response.stamp.sec > 0)
    print("same again", finish(send.call_async(request)).accepted)
    early = get.call_async(IMPL.GetResultService.Request(goal_id=goal_id(5)))
    until(lambda: statuses, executor)
    print("early", early.done(), statuses)
    held[0].execute()
    ended = finish(early)
    print("result", ended.status, ended.result.sequence)
    until(lambda: len(statuses) == 3 and heard, executor)
    print("feedback", [(int(each.goal_id.uuid[0]), each.feedback.sequence) for each in heard])
    print("statuses", statuses)
    for number in (5, 6):
        ended = finish(get.call_async(IMPL.GetResultService.Request(goal_id=goal_id(number))))
        print("result", number, ended.status, ended.result.sequence)
    request.goal_id = goal_id(6)
    finish(send.call_async(request))
    until(lambda: len(statuses) == 4, executor)
    print("two goals", statuses[-1])
    late = []
    node.create_subscription(
        IMPL.GoalStatusMessage, "served/_action/status", late.append, qos_profile_action_status_default
    )
    until(lambda: late, executor)
    print("late joiner", [each.status for each in late[0].status_list])
    volatile = []
    node.create_subscription(IMPL.GoalStatusMessage, "served/_action/status", volatile.append, 10)
    until(lambda: node.count_subscribers("/served/_action/status") == 3, executor)
    held[1].execute()
    until(lambda: len(volatile) == 2, executor)
    print("volatile", [[each.status for each in message.status_list] for message in volatile])
    server.destroy()


def graph(node, executor):
    """Action names and types, by node and in all; the hidden parts."""
    other = rclpy.create_node("other", namespace="/ns")
    executor.add_node(other)
    server = ActionServer(other, Fibonacci, "walk", lambda handle: None)
    private = ActionServer(other, NestedMessage, "~/nest", lambda handle: None)
    client = ActionClient(node, Fibonacci, "/ns/walk")
    print("found", client.wait_for_server(10.0))
    until(lambda: len(get_action_names_and_types(node)) >= 2, executor)

    def of(pairs):
        return [pair for pair in pairs if pair[0].startswith("/ns")]

    print("all", of(get_action_names_and_types(node)))
    print("served by other", get_action_server_names_and_types_by_node(node, "other", "/ns"))
    print("used by other", get_action_client_names_and_types_by_node(node, "other", "/ns"))
    print("used by node", of(get_action_client_names_and_types_by_node(node, "actor", "/")))
    for name, namespace in (("nobody", "/"), ("other", "/"), ("other", "ns"), ("", "/"), ("other", "")):
        for query in (get_action_server_names_and_types_by_node, get_action_client_names_and_types_by_node):
            attempt(
                f"{name!r} {namespace!r}",
                lambda query=query, name=name, namespace=namespace: query(node, name, namespace),
            )
    services = of(node.get_service_names_and_types_by_node("other", "/ns"))
    print("services", [pair for pair in services if topic_or_service_is_hidden(pair[0])])
    print("clients", of(node.get_client_names_and_types_by_node("actor", "/")))
    print(
        "topics",
        [
            pair
            for pair in of(node.get_publisher_names_and_types_by_node("other", "/ns"))
            if "_action" in pair[0]
        ],
    )
    print("subscribed", of(node.get_subscriber_names_and_types_by_node("actor", "/")))
    for part in ("feedback", "status"):
        (info,) = node.get_publishers_info_by_topic(f"/ns/walk/_action/{part}")
        print(
            part, info.node_name, info.topic_type, info.qos_profile.durability, info.qos_profile.reliability
        )
    client.destroy()
    server.destroy()
    until(lambda: len(of(get_action_names_and_types(node))) == 1, executor)
    print("left", of(get_action_names_and_types(node)))
    private.destroy()
    executor.remove_node(other)
    other.destroy_node()


def incompatible_parts(node, executor):
    """A server is available once all five parts match, not when they merely exist."""
    client, volatile = ActionClient(node, Fibonacci, "odd"), QoSProfile(depth=1)
    best_effort = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)
    server = RawServer(node, "odd")
    print("all match", client.wait_for_server(timeout_sec=10))
    node.destroy_publisher(server.status)
    until(lambda: not client.server_is_ready(), executor)
    print("no status", client.server_is_ready())
    late = node.create_publisher(IMPL.GoalStatusMessage, "odd/_action/status", volatile)
    print("volatile status", client.wait_for_server(timeout_sec=1))
    node.destroy_publisher(late)
    node.create_publisher(IMPL.GoalStatusMessage, "odd/_action/status", qos_profile_action_status_default)
    print("again", client.wait_for_server(timeout_sec=10))
    node.destroy_publisher(server.feedback)
    node.create_publisher(IMPL.FeedbackMessage, "odd/_action/feedback", best_effort)
    until(lambda: not client.server_is_ready(), executor)
    print("best effort feedback", client.wait_for_server(timeout_sec=1))
    client.destroy()


def main() -> None:
    """Play every case."""
    rclpy.init()
    node = rclpy.create_node("actor")
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    for case in (raw_server, raw_client, graph, incompatible_parts):
        print(f"--- {case.__name__}")
        case(node, executor)
    node.destroy_node()
    rclpy.shutdown()
