"""Services: calls, queues, several servers, errors, handles, introspection."""

import threading

import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.impl.implementation_singleton import rclpy_implementation as rcl
from rclpy.node import Node
from rclpy.qos import QoSProfile, qos_profile_services_default
from rclpy.service_introspection import ServiceIntrospectionState
from std_srvs.srv import Empty, SetBool
from test_msgs.srv import BasicTypes
from transcript import attempt, refused, spin_for, until


def calls(node: Node, executor: SingleThreadedExecutor) -> None:
    """Ordinary calls, a flood, two servers, none."""
    served: list[str] = []

    def serve(request: SetBool.Request, response: SetBool.Response) -> SetBool.Response:
        served.append(f"first {request.data}")
        response.success = request.data
        response.message = "done"
        return response

    client = node.create_client(SetBool, "calls")
    print(client.service_is_ready(), client.wait_for_service(timeout_sec=0.1))
    first = node.create_service(SetBool, "calls", serve)
    print(client.wait_for_service(timeout_sec=5.0), client.service_is_ready())
    future = client.call_async(SetBool.Request(data=True))
    print(future.done(), until(future.done, executor), future.result())
    served.clear()
    futures = [client.call_async(SetBool.Request(data=True)) for _ in range(25)]
    spin_for(1.0, executor)
    print(len(served), [number for number, future in enumerate(futures) if future.done()])
    second = node.create_service(
        SetBool, "calls", lambda request, response: served.append(f"second {request.data}") or response
    )
    until(lambda: node.get_service_names_and_types_by_node, seconds=0.2)
    served.clear()
    spin_for(0.2, executor)
    future = client.call_async(SetBool.Request(data=False))
    until(lambda: future.done() and len(served) == 2, executor)
    print(sorted(served), future.done())
    node.destroy_service(first)
    node.destroy_service(second)
    until(lambda: not client.service_is_ready())
    lost = client.call_async(SetBool.Request())
    third = node.create_service(SetBool, "calls", serve)
    client.wait_for_service()
    spin_for(0.3, executor)
    print("asked before there was a service:", lost.done())
    client.remove_pending_request(lost)
    client.remove_pending_request(lost)
    attempt("pending", lambda: client.get_pending_request(999))
    refused("call wrong", lambda: client.call(3))
    refused("call_async wrong", lambda: client.call_async(SetBool.Response()))
    attempt("call without a spinner", lambda: client.call(SetBool.Request(), timeout_sec=0.2))
    spin_for(0.2, executor)
    thread = threading.Thread(target=lambda: attempt("call", lambda: client.call(SetBool.Request(data=True))))
    thread.start()
    until(lambda: not thread.is_alive(), executor)
    print(client.service_name, client.srv_name, client.logger_name, third.service_name, third.srv_name)
    node.destroy_client(client)
    attempt("destroyed call", lambda: client.call_async(SetBool.Request()))
    attempt("destroyed wait", lambda: client.wait_for_service(timeout_sec=0.1))
    node.destroy_service(third)
    attempt("destroyed name", lambda: third.service_name)


def failing(node: Node, executor: SingleThreadedExecutor) -> None:
    """Callbacks that raise or return the wrong thing."""

    def raising(request: Empty.Request, response: Empty.Response) -> Empty.Response:
        raise RuntimeError("boom")

    for name, callback in (
        ("raises", raising),
        ("none", lambda request, response: None),
        ("wrong", lambda request, response: SetBool.Response()),
        ("request", lambda request, response: request),
    ):
        client = node.create_client(Empty, name)
        service = node.create_service(Empty, name, callback)
        client.wait_for_service()
        future = client.call_async(Empty.Request())
        show = attempt if callback is raising else refused
        show(name, lambda future=future: until(future.done, executor, seconds=1.0))
        print(future.done())
        node.destroy_service(service)
        node.destroy_client(client)


def handles(node: Node) -> None:
    """The client library's side, as custom executors and waitables use it."""
    profile = qos_profile_services_default.get_c_qos_profile()
    client = rcl.Client(node.handle, SetBool, "handles", profile)
    service = rcl.Service(node.handle, SetBool, "handles", profile)
    until(client.service_server_is_available)
    print(service.name, client.service_name, service.get_logger_name(), client.get_logger_name())
    print(service.qos)
    print(client.take_response(SetBool.Response), service.service_take_request(SetBool.Request))
    print(client.send_request(SetBool.Request(data=True)), client.send_request(SetBool.Request()))
    taken: list[object] = []
    for _ in range(2):
        until(lambda: taken.append(service.service_take_request(SetBool.Request)) or taken[-1][0])
        request, header = taken[-1]
        print(request, type(header).__name__, header.request_id.sequence_number)
        print(header.received_timestamp >= header.source_timestamp, type(header.request_id).__name__)
        service.service_send_response(SetBool.Response(message="one"), header.request_id)
    service.service_send_response(SetBool.Response(message="again"), header.request_id)
    for _ in range(3):
        until(lambda: taken.append(client.take_response(SetBool.Response)) or taken[-1][1])
        print(taken[-1][1], taken[-1][0].request_id.sequence_number)
    for make in (rcl.Client, rcl.Service):
        for name in ("a b", "", "/a//b"):
            attempt(f"{make.__name__} {name!r}", lambda m=make, n=name: m(node.handle, SetBool, n, profile))
    for cls in (rcl.rmw_service_info_t, rcl.rmw_request_id_t):
        try:
            cls()
        except TypeError:
            print(f"{cls.__name__} cannot be made")
    client.destroy_when_not_in_use()
    service.destroy_when_not_in_use()
    upper = node.create_service(SetBool, "upper", print)
    refused("send", lambda: upper.send_response(3, header))
    refused("send", lambda: upper.send_response(SetBool.Response(), 3))
    try:
        print(node.create_service(Empty, "upper", print))
    except Exception as error:
        print([cls.__name__ for cls in type(error).__mro__[:2]])


def introspection(node: Node, executor: SingleThreadedExecutor) -> None:
    """Events of both ends in each state."""
    events: list[BasicTypes.Event] = []
    node.create_subscription(BasicTypes.Event, "seen/_service_event", events.append, 100)

    def serve(request: BasicTypes.Request, response: BasicTypes.Response) -> BasicTypes.Response:
        response.string_value = request.string_value * 2
        return response

    client = node.create_client(BasicTypes, "seen")
    service = node.create_service(BasicTypes, "seen", serve)
    client.wait_for_service()
    profile = QoSProfile(depth=100)
    for of_client, of_service in (("OFF", "OFF"), ("METADATA", "CONTENTS"), ("CONTENTS", "OFF")):
        client.configure_introspection(
            node.get_clock(), profile, ServiceIntrospectionState.__members__[of_client]
        )
        service.configure_introspection(
            node.get_clock(), profile, ServiceIntrospectionState.__members__[of_service]
        )
        publishers = (of_client != "OFF") + (of_service != "OFF")
        until(lambda publishers=publishers: node.count_publishers("seen/_service_event") == publishers)
        spin_for(0.2, executor)
        future = client.call_async(BasicTypes.Request(string_value="ab"))
        until(future.done, executor)
        spin_for(0.2, executor)
        print(of_client, of_service, future.result().string_value)
        for event in sorted(events, key=lambda event: event.info.event_type):
            print(
                "  ",
                event.info.event_type,
                event.info.sequence_number,
                [request.string_value for request in event.request],
                [response.string_value for response in event.response],
                event.info.stamp.sec > 0,
                any(event.info.client_gid),
            )
        events.clear()
    print([name for name, _ in node.get_topic_names_and_types() if "seen" in name])
    node.destroy_client(client)
    node.destroy_service(service)


def main() -> None:
    """Run every part on one node."""
    rclpy.init()
    node = rclpy.create_node("n", start_parameter_services=False)
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    calls(node, executor)
    failing(node, executor)
    handles(node)
    introspection(node, executor)
    rclpy.shutdown()
