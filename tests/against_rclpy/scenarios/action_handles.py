"""The handles beneath actions, as upstream's own modules and tests use them."""

import rclpy
from action_msgs.msg import GoalInfo
from action_msgs.srv import CancelGoal
from rclpy.action import ActionClient, ActionServer
from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy
from test_msgs.action import Fibonacci, NestedMessage
from transcript import attempt, until
from unique_identifier_msgs.msg import UUID

IMPL = Fibonacci.Impl
EVENTS = [_rclpy.GoalEvent.EXECUTE, _rclpy.GoalEvent.CANCEL_GOAL, _rclpy.GoalEvent.SUCCEED]
EVENTS += [_rclpy.GoalEvent.ABORT, _rclpy.GoalEvent.CANCELED]
EXECUTE, CANCEL, SUCCEED, ABORT, CANCELED = EVENTS
PATHS = {
    "accepted": [],
    "executing": [EXECUTE],
    "canceling": [CANCEL],
    "canceling later": [EXECUTE, CANCEL],
    "succeeded": [EXECUTE, SUCCEED],
    "canceled": [CANCEL, CANCELED],
    "aborted": [EXECUTE, ABORT],
}


kept = []


def info(number):
    return GoalInfo(goal_id=UUID(uuid=[number] * 16))


def events():
    """The enumeration."""
    for event in EVENTS:
        print(repr(event), str(event), int(event), event.name, event == int(event))
    print(list(_rclpy.GoalEvent.__members__), _rclpy.GoalEvent(3).name)


def states(server):
    """Every event in every state."""
    number = 0
    for state, path in PATHS.items():
        for event in EVENTS:
            number += 1
            handle = _rclpy.ActionGoalHandle(server, info(number))
            for step in path:
                handle.update_goal_state(step)
            before = handle.get_status()
            attempt(
                f"{state} {event.name}", lambda handle=handle, event=event: handle.update_goal_state(event)
            )
            print(before, "->", handle.get_status(), handle.is_active())
            kept.append(handle)  # the real server crashes when a goal's handle is collected


def goals(server):
    """Acceptance, existence, expiry."""
    attempt("exists", lambda: server.goal_exists(info(101)))
    handle = _rclpy.ActionGoalHandle(server, info(101))
    attempt("exists", lambda: server.goal_exists(info(101)))
    attempt("same id", lambda: _rclpy.ActionGoalHandle(server, info(101)))
    attempt("new", lambda: (handle.get_status(), handle.is_active(), handle.pointer != 0))
    attempt("publish", server.publish_status)
    attempt("expire", lambda: server.expire_goals(3))
    attempt("expire", lambda: server.expire_goals(0))
    attempt("done", server.notify_goal_done)
    attempt("feedback", lambda: server.publish_feedback(IMPL.FeedbackMessage()))
    for number in (101, 102, 0):
        request = CancelGoal.Request(goal_info=info(number))
        response = server.process_cancel_request(request, CancelGoal.Response)
        print(
            type(response).__name__,
            response.return_code,
            [int(each.goal_id.uuid[0]) for each in response.goals_canceling],
        )
    handle.destroy_when_not_in_use()
    attempt("destroyed", handle.get_status)
    attempt("destroyed", handle.is_active)
    attempt("destroyed", lambda: handle.update_goal_state(EXECUTE))
    attempt("destroyed", lambda: handle.pointer)
    attempt("exists", lambda: server.goal_exists(info(101)))


def nothing_to_take(server, client):
    """Empty queues."""
    attempt("goal", lambda: server.take_goal_request(IMPL.SendGoalService.Request))
    attempt("cancel", lambda: server.take_cancel_request(IMPL.CancelGoalService.Request))
    attempt("result", lambda: server.take_result_request(IMPL.GetResultService.Request))
    attempt("goal", lambda: client.take_goal_response(IMPL.SendGoalService.Response))
    attempt("cancel", lambda: client.take_cancel_response(IMPL.CancelGoalService.Response))
    attempt("result", lambda: client.take_result_response(IMPL.GetResultService.Response))
    attempt("feedback", lambda: client.take_feedback(IMPL.FeedbackMessage))
    attempt("entities", client.get_num_entities)
    attempt("entities", server.get_num_entities)


def conversation(context, server, client):
    """Requests and responses by hand, found by a wait set."""
    until(client.is_action_server_available)

    def wait(handle):
        counts = handle.get_num_entities()
        wait_set = _rclpy.WaitSet(counts[0], counts[1], counts[2], counts[3], counts[4], 0, context)
        for _ in range(100):
            wait_set.clear_entities()
            handle.add_to_waitset(wait_set)
            wait_set.wait(100_000_000)
            if any(handle.is_ready(wait_set)):
                break
        return handle.is_ready(wait_set)

    print(
        "numbers",
        [
            client.send_goal_request(IMPL.SendGoalService.Request(goal=Fibonacci.Goal(order=n)))
            for n in (1, 2)
        ],
    )
    print("ready", wait(server))
    header, request = server.take_goal_request(IMPL.SendGoalService.Request)
    print("taken", type(header).__name__, request.goal.order, header.sequence_number)
    server.send_goal_response(header, IMPL.SendGoalService.Response(accepted=True))
    print("ready", wait(client))
    number, response = client.take_goal_response(IMPL.SendGoalService.Response)
    print("response", number, response.accepted)
    print("ready", wait(server))
    server.take_goal_request(IMPL.SendGoalService.Request)
    print("numbers", client.send_result_request(IMPL.GetResultService.Request()))
    print("ready", wait(server))
    header, _ = server.take_result_request(IMPL.GetResultService.Request)
    server.send_result_response(header, IMPL.GetResultService.Response(status=4))
    print("ready", wait(client))
    number, response = client.take_result_response(IMPL.GetResultService.Response)
    print("response", number, response.status)
    print("numbers", client.send_cancel_request(IMPL.CancelGoalService.Request()))
    print("ready", wait(server))
    header, request = server.take_cancel_request(IMPL.CancelGoalService.Request)
    server.send_cancel_response(header, IMPL.CancelGoalService.Response(return_code=2))
    print("ready", wait(client))
    print("response", client.take_cancel_response(IMPL.CancelGoalService.Response)[1].return_code)
    server.publish_feedback(IMPL.FeedbackMessage(feedback=Fibonacci.Feedback(sequence=[5])))
    print("ready", wait(client))
    print("feedback", client.take_feedback(IMPL.FeedbackMessage).feedback.sequence)
    server.publish_status()
    print("ready", wait(client))
    print("status", type(client.take_status(IMPL.GoalStatusMessage)).__name__)
    return header


def destroyed(server, client, header):
    """The error of each call afterwards."""
    goal = _rclpy.ActionGoalHandle(server, info(103))
    server.destroy_when_not_in_use()
    client.destroy_when_not_in_use()
    attempt("with", server.__enter__)
    attempt("with", client.__enter__)
    attempt("exists", lambda: server.goal_exists(info(103)))
    attempt("expire", lambda: server.expire_goals(1))
    attempt("cancel", lambda: server.process_cancel_request(CancelGoal.Request(), CancelGoal.Response))
    attempt("status", server.publish_status)
    attempt("feedback", lambda: server.publish_feedback(IMPL.FeedbackMessage()))
    attempt("done", server.notify_goal_done)
    attempt("send goal", lambda: server.send_goal_response(header, IMPL.SendGoalService.Response()))
    attempt("send cancel", lambda: server.send_cancel_response(header, IMPL.CancelGoalService.Response()))
    attempt("send result", lambda: server.send_result_response(header, IMPL.GetResultService.Response()))
    attempt("take goal", lambda: server.take_goal_request(IMPL.SendGoalService.Request))
    attempt("take cancel", lambda: server.take_cancel_request(IMPL.CancelGoalService.Request))
    attempt("take result", lambda: server.take_result_request(IMPL.GetResultService.Request))
    attempt("entities", server.get_num_entities)
    attempt("accept", lambda: _rclpy.ActionGoalHandle(server, info(104)))
    attempt("goal", lambda: goal.update_goal_state(EXECUTE))
    attempt("goal", goal.get_status)
    attempt("send goal", lambda: client.send_goal_request(IMPL.SendGoalService.Request()))
    attempt("send cancel", lambda: client.send_cancel_request(IMPL.CancelGoalService.Request()))
    attempt("send result", lambda: client.send_result_request(IMPL.GetResultService.Request()))
    attempt("take goal", lambda: client.take_goal_response(IMPL.SendGoalService.Response))
    attempt("take cancel", lambda: client.take_cancel_response(IMPL.CancelGoalService.Response))
    attempt("take result", lambda: client.take_result_response(IMPL.GetResultService.Response))
    attempt("take feedback", lambda: client.take_feedback(IMPL.FeedbackMessage))
    attempt("take status", lambda: client.take_status(IMPL.GoalStatusMessage))
    attempt("entities", client.get_num_entities)
    attempt("available", client.is_action_server_available)


def after_shutdown(node, server, client):
    """Use the handles after the context is gone."""
    goal = _rclpy.ActionGoalHandle(server._handle, info(105))
    rclpy.shutdown()
    attempt("status", server._handle.publish_status)
    attempt("feedback", lambda: server._handle.publish_feedback(IMPL.FeedbackMessage()))
    attempt("goal", lambda: goal.update_goal_state(EXECUTE))
    attempt("accept", lambda: _rclpy.ActionGoalHandle(server._handle, info(106)))
    attempt("ready", client.server_is_ready)
    attempt("wait", lambda: client.wait_for_server(1.0))
    attempt("server", lambda: ActionServer(node, Fibonacci, "late", print))
    attempt("client", lambda: ActionClient(node, Fibonacci, "late"))


def objects(node):
    """The same on the objects that programs have."""
    server = ActionServer(node, Fibonacci, "again", print)
    client = ActionClient(node, Fibonacci, "again")
    print("waitables", server in list(node.waitables), client in list(node.waitables))
    try:
        ActionServer(node, NestedMessage, "again", print)
    except ValueError as error:  # the rest is in DDS's words
        print("other type", str(error).partition(" called for existing ")[0])
    server.destroy()
    client.destroy()
    print("waitables", server in list(node.waitables), client in list(node.waitables))
    attempt("server again", server.destroy)
    attempt("client again", client.destroy)
    attempt("send", lambda: client.send_goal_async(Fibonacci.Goal()))
    attempt("done", server.notify_goal_done)
    attempt("with", server.__enter__)
    attempt("with", client.__enter__)
    client = ActionClient(node, Fibonacci, "again")
    node.destroy_node()
    attempt("ready", client.server_is_ready)
    attempt("server", lambda: ActionServer(node, Fibonacci, "again", print))
    attempt("client", lambda: ActionClient(node, Fibonacci, "again"))
    attempt("destroy", client.destroy)


def main() -> None:
    """Play every case."""
    rclpy.init()
    node = rclpy.create_node("actor")
    server = ActionServer(node, Fibonacci, "fib", lambda handle: None)
    client = ActionClient(node, Fibonacci, "fib")
    events()
    states(server._handle)
    goals(server._handle)
    nothing_to_take(server._handle, client._client_handle)
    header = conversation(node.context.handle, server._handle, client._client_handle)
    destroyed(server._handle, client._client_handle, header)
    objects(rclpy.create_node("other"))
    after_shutdown(node, ActionServer(node, Fibonacci, "last", print), ActionClient(node, Fibonacci, "last"))
