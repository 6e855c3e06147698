"""A topic, a service with its events, an action and a type description, all from a never-compiled package."""

from common import rclpy, spin_until
from humanoid_interfaces.action import WalkTo
from humanoid_interfaces.msg import Footstep, FootstepPlan
from humanoid_interfaces.srv import AddTwoInts
from rclpy.action import ActionClient, ActionServer, CancelResponse, GoalResponse
from rclpy.action.server import ServerGoalHandle
from rclpy.qos import qos_profile_system_default
from rclpy.service_introspection import ServiceIntrospectionState
from type_description_interfaces.srv import GetTypeDescription

rclpy.init()
node = rclpy.create_node("never_compiled")

# topic
plans: list[FootstepPlan] = []
node.create_subscription(FootstepPlan, "plan", plans.append, 10)
publisher = node.create_publisher(FootstepPlan, "plan", 10)
spin_until(node, publisher.get_subscription_count)
plan = FootstepPlan(steps=[Footstep(index=3, leg=Footstep.LEG_LEFT)])
plan.header.stamp = node.get_clock().now().to_msg()  # a compiled Time
publisher.publish(plan)
spin_until(node, lambda: plans)
print("topic", plans == [plan])
print(
    "hash", str(node.get_publishers_info_by_topic("/plan")[0].topic_type_hash) == FootstepPlan.__type_hash__
)


# service, its events with and without contents
def add(request: AddTwoInts.Request, response: AddTwoInts.Response) -> AddTwoInts.Response:
    response.sum = request.a + request.b
    return response


service = node.create_service(AddTwoInts, "add", add)
client = node.create_client(AddTwoInts, "add")
events: list[AddTwoInts.Event] = []
subscription = node.create_subscription(AddTwoInts.Event, "add/_service_event", events.append, 10)
client.wait_for_service()
for state in (ServiceIntrospectionState.CONTENTS, ServiceIntrospectionState.METADATA):
    for end in (client, service):
        end.configure_introspection(node.get_clock(), qos_profile_system_default, state)
    spin_until(node, lambda: node.count_publishers("/add/_service_event") == 2)
    spin_until(node, lambda: False, 0.3)  # both are matched by now, or the events below will show it
    events.clear()
    future = client.call_async(AddTwoInts.Request(a=2, b=40))
    spin_until(node, lambda asked=future: asked.done() and len(events) == 4)
    print("service", future.result().sum)
    for event in sorted(events, key=lambda event: event.info.event_type):
        print(" event", event.info.event_type, event.request, event.response)


# action
def execute(goal: ServerGoalHandle) -> WalkTo.Result:
    goal.publish_feedback(WalkTo.Feedback(distance_left=1.0))
    goal.succeed()
    return WalkTo.Result(outcome=WalkTo.Result.OUTCOME_REACHED)


def accept(goal: WalkTo.Goal) -> GoalResponse:
    return GoalResponse.REJECT if goal.position_tolerance < 0 else GoalResponse.ACCEPT


server = ActionServer(
    node,
    WalkTo,
    "walk",
    execute,
    goal_callback=accept,
    cancel_callback=lambda goal: CancelResponse.ACCEPT,
    handle_accepted_callback=lambda goal: None if goal.request.max_step_length else goal.execute(),
)
walker = ActionClient(node, WalkTo, "walk")
spin_until(node, walker.server_is_ready)
feedback: list[float] = []


def send(goal: WalkTo.Goal):
    sent = walker.send_goal_async(goal, lambda message: feedback.append(message.feedback.distance_left))
    spin_until(node, sent.done)
    return sent.result()


handle = send(WalkTo.Goal())
spin_until(node, lambda: feedback)  # rclpy drops feedback after the result
result = handle.get_result_async()
spin_until(node, result.done)
print("action", result.result().status, result.result().result.outcome, feedback)
print("rejected", not send(WalkTo.Goal(position_tolerance=-1.0)).accepted)
handle = send(WalkTo.Goal(max_step_length=0.1))  # deferred, never executed
canceling = handle.cancel_goal_async()
spin_until(node, canceling.done)
print("canceling", len(canceling.result().goals_canceling))

# type description
asker = node.create_client(GetTypeDescription, "~/get_type_description")
asked = asker.call_async(
    GetTypeDescription.Request(
        type_name="humanoid_interfaces/msg/FootstepPlan",
        type_hash=FootstepPlan.__type_hash__,
        include_type_sources=True,
    )
)
spin_until(node, asked.done)
answer = asked.result()
print("described", answer.successful, answer.type_description.type_description.type_name)
for source in answer.type_sources:
    if source.type_name.startswith("humanoid_interfaces/"):
        print(" source", source.type_name, source.encoding, source.raw_file_contents.startswith("#"))
node.destroy_node()
rclpy.shutdown()
