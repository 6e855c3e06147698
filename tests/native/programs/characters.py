"""A message with IDL's `char`, from a publisher to a subscription, and its type description."""

from codec_msgs.msg import Letter, Letters
from common import rclpy, spin_until
from type_description_interfaces.srv import GetTypeDescription

rclpy.init()
node = rclpy.create_node("characters")
received: list[Letters] = []
node.create_subscription(Letters, "letters", received.append, 1)
publisher = node.create_publisher(Letters, "letters", 1)
spin_until(node, publisher.get_subscription_count)
publisher.publish(Letters(first="\xff", triple=["a", "b", "c"], letters=[Letter(a="k"), Letter(a="m")]))
spin_until(node, lambda: received)
(message,) = received
print(ascii(message.first), "".join(message.triple), *(letter.a for letter in message.letters))

asker = node.create_client(GetTypeDescription, "~/get_type_description")
request = GetTypeDescription.Request(
    type_name="codec_msgs/msg/Letters", type_hash=Letters.__type_hash__, include_type_sources=True
)
asked = asker.call_async(request)
spin_until(node, asked.done)
answer = asked.result()
fields = {field.name: field.type.type_id for field in answer.type_description.type_description.fields}
print(fields["first"], fields["triple"], [source.encoding for source in answer.type_sources])
node.destroy_node()
rclpy.shutdown()
