"""Services: calls in both directions, at the same time, before there is a server and after it is gone."""

import threading

from rclpy.qos import QoSProfile
from rclpy.service_introspection import ServiceIntrospectionState
from stage import Stage
from std_srvs.srv import SetBool, Trigger
from test_msgs.srv import Arrays


def server(stage: Stage) -> None:
    """Answers, at once or later."""
    stage.meet()
    node = stage.node("server", namespace="/there")
    asked = []

    def switch(request, response):
        asked.append(request.data)
        response.success, response.message = not request.data, f"{len(asked)}"
        return response

    service = node.create_service(SetBool, "switch", switch)
    service.configure_introspection(
        node.get_clock(), QoSProfile(depth=10), ServiceIntrospectionState.CONTENTS
    )

    def arrays(request, response):
        response.float64_values = [value * 0.1 for value in request.float64_values]
        response.string_values = [value[::-1] for value in request.string_values]
        return response

    node.create_service(Arrays, "arrays", arrays)
    stage.meet()
    stage.meet()  # they have been called
    stage.say(sorted(asked))
    client = node.create_client(Trigger, "/trigger")
    stage.until(client.service_is_ready)
    stage.say(stage.result(client.call_async(Trigger.Request())).message)
    stage.meet()
    node.destroy_service(service)
    stage.meet()
    asked.clear()
    node.create_service(SetBool, "switch", switch)
    stage.meet()
    stage.say(asked)


def client(stage: Stage) -> None:
    """Asks."""
    node = stage.node("client")
    client = node.create_client(SetBool, "/there/switch")
    stage.say("ready", client.service_is_ready(), client.wait_for_service(timeout_sec=0.05))
    stage.meet()
    stage.until(client.service_is_ready)
    stage.say("ready", client.wait_for_service(timeout_sec=0.05))
    events = []
    node.create_subscription(
        SetBool.Event, "/there/switch/_service_event", lambda event: events.append(event.info.event_type), 10
    )
    stage.until(lambda: node.count_publishers("/there/switch/_service_event"))
    stage.spin(0.3)
    arrays = node.create_client(Arrays, "/there/arrays")
    stage.until(arrays.service_is_ready)
    stage.meet()
    futures = [client.call_async(SetBool.Request(data=bool(number % 2))) for number in range(4)]
    answers = [stage.result(future) for future in futures]
    stage.say([answer.success for answer in answers], sorted(answer.message for answer in answers))
    stage.until(lambda: len(events) == 8, "the introspection")
    stage.say(sorted(events))
    response = stage.result(
        arrays.call_async(Arrays.Request(float64_values=[0.1, -2.5, 1e300], string_values=["", "ä", "abc"]))
    )
    stage.say(list(response.float64_values), response.string_values)
    blocked = []
    thread = threading.Thread(
        target=lambda: blocked.append(client.call(SetBool.Request(data=True), timeout_sec=20.0))
    )
    thread.start()
    stage.until(lambda: blocked, "a call that blocks")
    thread.join()
    stage.say("blocked", blocked[0].success)

    def trigger(_, response):
        response.message = "from the other side"
        return response

    node.create_service(Trigger, "/trigger", trigger)
    stage.meet()
    stage.meet()  # the server is destroyed
    stage.until(lambda: not client.service_is_ready())
    pending = client.call_async(SetBool.Request())
    stage.spin(0.2)
    stage.say("without a server", pending.done(), client.wait_for_service(timeout_sec=0.05))
    client.remove_pending_request(pending)
    stage.meet()
    stage.until(client.service_is_ready)
    stage.say("again", stage.result(client.call_async(SetBool.Request(data=False))).message)
    stage.meet()


ROLES = {
    "server": server,
    "client": client,
}
