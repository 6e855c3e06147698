"""A subclass as users of nodl_generator_py write it, with nothing that only ifgen has."""

import rclpy
from echo_nodes.generated.echo_base import EchoBase
from rclpy.executors import SingleThreadedExecutor
from rclpy.parameter import Parameter
from std_msgs.msg import String
from std_srvs.srv import Trigger


class Echo(EchoBase):
    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.colour = self.params_.colour.r

    def on_echo_in(self, msg):
        prefix = self.param_listener_.get_params().prefix
        self.pub_echo_out.publish(String(data=f"{prefix}{msg.data}"))

    def on_go(self, request, response):
        response.success = True
        return response

    def execute_fib(self, goal_handle):
        raise NotImplementedError


rclpy.init(args=[])
node, peer = Echo(), rclpy.create_node("peer")
heard = []
peer.create_subscription(String, "/echo_out", heard.append, 1)
publisher = peer.create_publisher(String, "/echo_in", 1)
client = peer.create_client(Trigger, "/echo/go")
executor = SingleThreadedExecutor()
executor.add_node(node)
executor.add_node(peer)
for number in range(2):
    expected = len(heard) + 1
    while publisher.get_subscription_count() < 1 or peer.count_publishers("/echo_out") < 1:
        executor.spin_once(timeout_sec=0.1)
    while len(heard) < expected:
        publisher.publish(String(data=f"hello {number}"))
        executor.spin_once(timeout_sec=0.1)
    old = node.param_listener_.get_params()
    node.set_parameters([Parameter("prefix", value=f"{number}: ")])
    print(heard[-1].data, node.param_listener_.is_old(old))
while not client.service_is_ready():
    executor.spin_once(timeout_sec=0.1)
future = client.call_async(Trigger.Request())
executor.spin_until_future_complete(future, timeout_sec=10)
print(future.result().success, node.colour, node.get_name())
names = (
    "pub_echo_out",
    "pub_a_b",
    "sub_echo_in",
    "srv_go",
    "cli_other_go",
    "action_srv_fib",
    "action_cli_other_fib",
)
print(all(hasattr(node, name) for name in names))
servers = [name for name, _ in node.get_service_names_and_types_by_node("echo", "/")]
print(servers.count("/echo/list_parameters"))
rclpy.shutdown()
