"""The fixture messages and pairs of test_msgs: which ones exist, and that they survive the wire."""

import inspect

from rclpy.serialization import deserialize_message, serialize_message
from test_msgs import message_fixtures, service_fixtures

MESSAGES = (
    "Arrays",
    "BasicTypes",
    "BoundedPlainSequences",
    "BoundedSequences",
    "Builtins",
    "Constants",
    "Defaults",
    "Empty",
    "MultiNested",
    "Nested",
    "Strings",
    "UnboundedSequences",
    "WStrings",
)


def survives(message: object) -> bool:
    return deserialize_message(serialize_message(message), type(message)) == message


def main() -> None:
    for module in (message_fixtures, service_fixtures):
        functions = (name for name, value in vars(module).items() if inspect.isfunction(value))
        print(sorted(name for name in functions if name.startswith(("get_msg_", "get_test", "int_"))))
    for name in MESSAGES:
        messages = message_fixtures.get_test_msg(name)
        print(name, type(messages[0]).__name__, len(messages), all(map(survives, messages)))
    for name in ("Arrays", "BasicTypes", "Empty"):
        pairs = service_fixtures.get_test_srv(name)
        print(name, [[type(part).__name__ for part in pair] for pair in pairs])
        print(all(survives(part) for pair in pairs for part in pair))
    print([message_fixtures.int_from_uint(value, 8) for value in (0, 1, 127, 128, 255, 256, 511)])
    for get in (message_fixtures.get_test_msg, service_fixtures.get_test_srv):
        try:
            get("Nonsense")
        except NotImplementedError:
            print("unknown")
