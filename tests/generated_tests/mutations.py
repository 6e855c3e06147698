"""Mutations of generated code, and the generated tests that must notice them."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Mutation:
    """A change of one file of a package, with `NODE` for the node's name, and the tests that must fail for it."""

    node: str
    path: str
    old: str
    new: str
    noticed_by: str

    def __str__(self) -> str:
        return f"{self.node}: {self.old.strip()} -> {self.new.strip()}"


BASE = "{package}/_{node}_base.py"
PARAMETERS = "{package}/_{node}_parameters.py"


def base(node: str, old: str, new: str, noticed_by: str) -> Mutation:
    return Mutation(node, BASE, old, new, noticed_by)


def parameters(old: str, new: str, noticed_by: str) -> Mutation:
    return Mutation("tuned", PARAMETERS, old, new, noticed_by)


MUTATIONS = [
    # Topics: names, types, quality of service, methods.
    base("talker", "depth=7", "depth=6", "test_publisher[/state]"),
    base("talker", "DurabilityPolicy.TRANSIENT_LOCAL", "DurabilityPolicy.VOLATILE", "test_publisher[/state]"),
    base("talker", "400_000_000", "200_000_000", "test_publisher[/state]"),
    base("talker", "ReliabilityPolicy.BEST_EFFORT", "ReliabilityPolicy.RELIABLE", "test_publisher[~/load]"),
    base("talker", '"~/load"', '"load"', "test_publisher[~/load]"),
    base("talker", "            Float32,\n", "            String,\n", "test_publisher[~/load]"),
    base("talker", "self.load_publisher.publish(message)", "pass", "test_publisher[~/load]"),
    base("talker", '"/command"', '"/commands"', "test_subscription[/command]"),
    base("talker", "self.on_command,", "print,", "test_subscription[/command]"),
    base("talker", "depth=5", "depth=50", "test_subscription[/command]"),
    # Rates.
    base("talker", "            0.2,", "            0.3,", "test_timer[on_beat_timer]"),
    base("talker", "            0.2,", "            0.1,", "test_timer[on_beat_timer]"),
    base("talker", "self.on_beat_timer,", "print,", "test_timer[on_beat_timer]"),
    base("thinker", "            0.2,", "            0.6,", "test_timer[on_think_timer]"),
    base(
        "thinker",
        "            clock=Clock(clock_type=ClockType.STEADY_TIME),\n",
        "",
        "test_timer[on_think_timer]",
    ),
    # Services.
    base("server", '"~/add"', '"~/sum"', "test_service[~/add]"),
    base("server", "self.handle_add,", "lambda _, response: None,", "test_service[~/add]"),
    base("server", "depth=10", "depth=1", "test_service[~/add]"),
    base("server", '"/switch"', '"switches"', "test_client[/switch]"),
    base("server", "call_async(request)", "call_async(SetBool.Request())", "test_client[/switch]"),
    base(
        "thinker",
        "request,\n            timeout_sec,",
        "request,\n            1e9,",
        "test_client_without_a_service",
    ),
    base("thinker", "return response", "return SetBool.Response()", "test_client[/switch]"),
    # Actions.
    base("actor", '"/count"', '"/counts"', "test_action_server[/count]"),
    base("actor", "goal_callback=self.accept_count,", "", "test_action_server_rejects[/count]"),
    base("actor", "cancel_callback=self.cancel_count,", "", "test_action_server_cancels[/count]"),
    base("actor", "self.execute_count,", "lambda _: Fibonacci.Result(),", "test_action_server[/count]"),
    base("actor", '"/other"', '"/others"', "test_action_client[/other]"),
    base("actor", ", feedback_callback=hear", "", "test_action_client[/other]"),
    base("actor", "send_goal_async(goal,", "send_goal_async(Fibonacci.Goal(),", "test_action_client[/other]"),
    base("thinker", "cancel_callback=self.cancel_think,", "", "test_action_server_cancels[/think]"),
    Mutation(
        "thinker",
        "{package}/_waiting.py",
        "self._feedback.append(message.feedback)",
        "",
        "test_action_client[/other]",
    ),
    Mutation(
        "thinker",
        "{package}/_waiting.py",
        "if not handle.accepted",
        "if False",
        "test_action_client_is_rejected",
    ),
    # Parameters: defaults, limits, every rule, and the effect of a change.
    parameters("            0.5,", "            0.25,", "test_parameter[gain]"),
    parameters("How much", "How little", "test_parameter[gain]"),
    parameters("to_value=1.0", "to_value=2.0", "test_parameter[gain]"),
    parameters("value > 0,", "value > -9,", "test_parameter[count]"),
    parameters("value <= 9,", "value < 9,", "test_parameter[count]"),
    parameters("value <= 9,", "value <= 10,", "test_parameter[count]"),
    parameters('value in ["stand", "walk"]', "True", "test_parameter[mode]"),
    parameters('["stand", "walk"]', '["stand"]', "test_parameter[mode]"),
    parameters("len(set(value)) == len(value)", "True", "test_parameter[joints]"),
    parameters("(lambda value: len(value) > 0,", "(lambda value: True,", "test_parameter[joints]"),
    parameters("len(value) < 4", "len(value) < 5", "test_parameter[joints]"),
    parameters("len(value) <= 3", "len(value) <= 4", "test_parameter[limits]"),
    parameters("-1.0 <= element", "-1.5 <= element", "test_parameter[limits]"),
    parameters("read_only=True,", "", "test_parameter[name]"),
    parameters("add_on_set_parameters_callback(_refuse)", "get_name()", "test_parameter_at_start[mode]"),
    base("tuned", "        self.parameters = parameters\n", "        pass\n", "test_parameter[mode]"),
    # Lifecycle.
    base("managed", "create_lifecycle_publisher", "create_publisher", "test_silent_until_active[/sample]"),
    base("managed", "self.sample_timer.reset()", "pass", "test_timer[on_sample_timer]"),
    base("managed", "self._configured.close()", "pass", "test_silent_until_active[/sample]"),
]
