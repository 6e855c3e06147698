"""Every mistake is one clear error at the right place. `⟦...⟧` marks what the caret must point at."""

from __future__ import annotations

import re

import pytest

from .conftest import Load

QOS = "qos: {history: KEEP_LAST, depth: 1, reliability: RELIABLE}"


def endpoint(
    line: str, category: str = "publishers", name: str = "/a", type_: str = "std_msgs/msg/String"
) -> str:
    """A document with one topic, in which one line is different."""
    lines = {"name": f"name: {name}", "type": f"type: {type_}", "qos": QOS}
    key = re.sub(r"[^a-z].*", "", line.replace("⟦", ""))
    lines[key if key in lines else "description"] = line
    return f"nodl_version: 2\n{category}:\n  - " + "\n    ".join(lines.values()) + "\n"


def parameter(text: str, name: str = "p") -> str:
    """A document with one parameter."""
    return f"nodl_version: 2\nparameters:\n  {name}: {{{text}}}\n"


def options(text: str, rest: str = "") -> str:
    """A document with something under codegen.ifgen."""
    return f"nodl_version: 2\ncodegen:\n  ifgen:\n    {text}\n{rest}"


CLIENT = "service_clients: [{name: a, type: std_srvs/Trigger}]\n"
STRUCTS = [
    ("invalid-option", "structs: {g: {each: ⟦joints⟧, of: {p: {type: int}}}}", "string_array with a default"),
    ("missing-key", "structs: {g: ⟦{of: {p: {type: int}}}⟧}", "`each`"),
    ("missing-key", "structs: {g: ⟦{each: [a]}⟧}", "`of`"),
    ("unknown-key", "structs: {g: {each: [a], of: {}, ⟦ofs⟧: 1}}", "did you mean `of`"),
    ("unknown-key", "structs: {g: {each: [a], of: {p: {type: int, ⟦unit⟧: m}}}}", "`unit`"),
    ("unusable-name", "structs: {g: {each: [⟦a-b⟧], of: {p: {type: int}}}}", "`a-b`"),
    ("unusable-name", "structs: {g: {each: [⟦__a⟧], of: {p: {type: int}}}}", "private in Python"),
    ("duplicate-parameter", "structs: {g: {each: [a, ⟦a⟧], of: {p: {type: int}}}}", "`g.a.p`"),
]
A_DOUBLE = "parameters:\n  period: {type: double}\n  count: {type: int}\n"

SYNTAX = [
    ("empty-document", "⟦⟧# nothing\n", "nodl_version: 2"),
    ("wrong-value", "⟦- a⟧\n", "must be a map"),
    ("wrong-value", "⟦plain text⟧\n", "this is a text"),
    ("yaml-syntax", "nodl_version: 2\npublishers: [a⟦\n⟧", "not YAML"),
    ("yaml-syntax", "nodl_version: 2\npublishers:\n⟦\t⟧- a\n", "tabs"),
    ("yaml-syntax", "nodl_version: 2\ndescription: a⟦\x07⟧b\n", "U+0007"),
    ("several-documents", "nodl_version: 2\n⟦---⟧\nnodl_version: 2\n", "second document"),
    ("yaml-tag", "nodl_version: 2\ndescription: ⟦!!str⟧ 5\n", "quotes"),
    ("yaml-tag", "nodl_version: 2\npublishers: ⟦!!python/object:os.system⟧ []\n", "not read"),
    ("unknown-anchor", "nodl_version: 2\npublishers: ⟦*nobody⟧\n", "no anchor"),
    ("unknown-anchor", "nodl_version: 2\ncodegen: {x: &me [⟦*me⟧]}\n", "inside its own value"),
    ("duplicate-key", "nodl_version: 2\n⟦nodl_version⟧: 2\n", "there twice"),
    ("no-text-key", "nodl_version: 2\n⟦on⟧: 2\n", '"on"'),
    ("no-text-key", "nodl_version: 2\n⟦1⟧: 2\n", "an integer"),
    ("no-text-key", "nodl_version: 2\n? ⟦[a]⟧\n: 2\n", "a list"),
    ("wrong-value", "nodl_version: 2\n<<: ⟦5⟧\n", "merges a map"),
    ("yaml-syntax", f"%YAML 1.⟦1⟧{'1' * 5000}\n---\nnodl_version: 2\n", "too large"),
    ("invalid-text", 'nodl_version: 2\ndescription: ⟦"\\ud800"⟧\n', "surrogate"),
    ("invalid-text", 'nodl_version: 2\ndescription: ⟦"a\\0b"⟧\n', "NUL"),
    ("invalid-text", parameter('type: string, default_value: ⟦"\\x00"⟧'), "strings of ROS end there"),
    ("yaml-syntax", 'nodl_version: 2\ndescription: "a⟦\\UFFFFFFFF⟧b"\n', "U+10FFFF"),
    ("yaml-syntax", 'nodl_version: 2\ndescription: "⟦\\U00110000⟧"\n', "U+10FFFF"),
    ("invalid-number", f"nodl_version: 2\ncodegen: {{x: {{y: ⟦{'9' * 5000}⟧}}}}\n", "not a number"),
    ("unclear-number", parameter("type: int, default_value: ⟦010⟧"), "as 8"),
]

DOCUMENT = [
    ("missing-key", "⟦⟧description: a\n", "nodl_version: 2"),
    ("nodl-version", "nodl_version: ⟦1⟧\n", "write `nodl_version: 2`"),
    ("nodl-version", "nodl_version: ⟦'2'⟧\n", "write `nodl_version: 2`"),
    ("nodl-version", "nodl_version: ⟦true⟧\n", "write `nodl_version: 2`"),
    ("unknown-key", "nodl_version: 2\n⟦publisher⟧: []\n", "did you mean `publishers`"),
    ("wrong-value", "nodl_version: 2\ndescription: ⟦2020-01-01⟧\n", "quotes"),
    ("wrong-value", "nodl_version: 2\ndescription: ⟦yes⟧\n", '"yes"'),
    ("wrong-value", "nodl_version: 2\npublishers: ⟦{a: 1}⟧\n", "a list of endpoints"),
    ("wrong-value", "nodl_version: 2\npublishers: [⟦5⟧]\n", "a publisher must be a map"),
    ("wrong-value", "nodl_version: 2\ncodegen: {cpp: ⟦5⟧}\n", "must be a map"),
    ("wrong-value", "nodl_version: 2\nparameters: ⟦[]⟧\n", "a map from names"),
    ("invalid-include", "nodl_version: 2\ninclude: [{ref: ⟦other.nodl.yaml⟧}]\n", "local://"),
    ("unknown-include", "nodl_version: 2\ninclude: [{ref: ⟦loca://x⟧}]\n", "did you mean `local://`"),
    (
        "unknown-include",
        "nodl_version: 2\ninclude: [{ref: ⟦local://talkr.nodl.yaml⟧}]\n",
        "`talker.nodl.yaml`",
    ),
    ("unknown-include", "nodl_version: 2\ninclude: [{ref: ⟦nodl://demo/talkr⟧}]\n", "did you mean `talker`"),
    ("unknown-include", "nodl_version: 2\ninclude: [{ref: ⟦nodl://nowhere/x⟧}]\n", "-I DIR"),
    ("unknown-key", "nodl_version: 2\ninclude: [{⟦uri⟧: a, ref: 'local://part.nodl.yaml'}]\n", "has no key"),
]

ENDPOINTS = [
    ("missing-key", f"nodl_version: 2\npublishers:\n  - ⟦type: std_msgs/String\n    {QOS}⟧", "`name`"),
    ("missing-key", "nodl_version: 2\npublishers:\n  - ⟦{name: a, type: std_msgs/String}⟧\n", "`qos`"),
    ("unknown-key", endpoint("⟦topic⟧: a"), "a publisher has no key"),
    ("unknown-key", "nodl_version: 2\naction_clients: [{name: a, type: example_interfaces/Fibonacci, ⟦qos⟧: {}}]\n", "an action client"),
    ("wrong-value", endpoint("name: ⟦~⟧"), "this is nothing"),
    ("unusable-name", endpoint("name: ⟦~⟧a"), "did you mean `~/a`"),
    ("unusable-name", endpoint("name: a⟦//⟧b"), "did you mean `a/b`"),
    ("unusable-name", endpoint("name: a/⟦1⟧b"), "digit"),
    ("invalid-name", endpoint("name: a/b⟦/⟧"), "end with"),
    ("invalid-name", endpoint("name: a⟦-⟧b"), "letters, digits and underscores"),
    ("invalid-name", endpoint("name: a⟦{⟧ns}"), "substitutions"),
    ("invalid-name", endpoint("name: ⟦''⟧"), "empty"),
    ("invalid-name", endpoint("name: ⟦_⟧a"), "hides"),
    ("invalid-type", endpoint("type: ⟦std_msgs.msg.String⟧"), "did you mean `std_msgs/msg/String`"),
    ("invalid-type", endpoint("type: ⟦std_msgs::msg::String⟧"), "did you mean `std_msgs/msg/String`"),
    ("invalid-type", endpoint("type: ⟦Imu⟧"), "did you mean `sensor_msgs/msg/Imu`"),
    ("invalid-type", endpoint("type: ⟦nonsense⟧"), "package/msg/Name"),
    ("unknown-type", endpoint("type: ⟦geometry_msgs/Imu⟧"), "did you mean `sensor_msgs/msg/Imu`"),
    ("unknown-type", endpoint("type: ⟦std_msgs/msg/Strin⟧"), "did you mean `String`"),
    ("unknown-type", endpoint("type: ⟦std_srvs/Trigger⟧"), "is a service"),
    ("unknown-package", endpoint("type: ⟦std_msg/msg/String⟧"), "did you mean `std_msgs`"),
    ("wrong-interface-kind", endpoint("type: ⟦std_srvs/srv/Trigger⟧"), "`service_servers`"),
    ("missing-key", endpoint("qos: {history: ⟦KEEP_LAST⟧, reliability: RELIABLE}"), "`depth: 10`"),
    ("missing-key", endpoint("qos: ⟦{history: KEEP_ALL}⟧"), "`reliability`"),
    ("unknown-key", endpoint("qos: {history: KEEP_ALL, reliability: RELIABLE, ⟦deadline⟧: 5}"), "deadline_ns"),
    ("unknown-value", endpoint("qos: {history: KEEP_ALL, reliability: ⟦reliable⟧}"), "did you mean `RELIABLE`"),
    ("unknown-value", endpoint("qos: {history: KEEP_ALL, reliability: RELIABLE, durability: ⟦PERSISTENT⟧}"), "TRANSIENT_LOCAL"),
    ("wrong-value", endpoint("qos: {history: ⟦5⟧, reliability: RELIABLE}"), "KEEP_ALL"),
    ("wrong-value", endpoint("qos: {history: KEEP_LAST, depth: ⟦0⟧, reliability: RELIABLE}"), "`depth` must be 1 or more this is 0"),
    ("too-large-number", endpoint("qos: {history: KEEP_LAST, depth: ⟦2147483648⟧, reliability: RELIABLE}"), "must be 2147483647 or less"),
    ("too-large-number", endpoint(f"qos: {{history: KEEP_LAST, depth: ⟦0x{'f' * 5000}⟧, reliability: RELIABLE}}"), "or less this is 0xff"),
    ("wrong-value", endpoint("qos: {history: KEEP_LAST, depth: ⟦true⟧, reliability: RELIABLE}"), "from 1"),
    ("wrong-value", endpoint("qos: {history: KEEP_LAST, depth: ⟦1e1⟧, reliability: RELIABLE}"), "write `1.0e+1`"),
    ("wrong-value", endpoint("qos: {history: KEEP_ALL, reliability: RELIABLE, deadline_ns: ⟦-1⟧}"), "`deadline_ns` must be 0 or more this is -1 to leave it open, write 0"),
    ("wrong-value", endpoint("qos: {history: KEEP_ALL, reliability: RELIABLE, deadline_ns: ⟦2.5⟧}"), "an integer"),
    ("duplicate-endpoint", endpoint("name: a") + endpoint("name: ⟦a⟧").split("publishers:\n")[1], "two publishers"),
    ("same-endpoint", endpoint("name: /a") + endpoint("name: ⟦a⟧").split("publishers:\n")[1], "this is `/a`"),
    ("same-endpoint", endpoint("name: /talker/a") + endpoint("name: ⟦~/a⟧").split("publishers:\n")[1], "`/talker/a`"),
    ("two-types", endpoint("name: /a") + endpoint("name: ⟦a⟧", "subscriptions", type_="std_msgs/Bool").removeprefix("nodl_version: 2\n"), "std_msgs/msg/Bool"),
    ("same-method", endpoint("name: /a/b") + endpoint("name: ⟦a_b⟧").split("publishers:\n")[1], "longer name"),
    ("never-meet", endpoint("name: /a") + endpoint("qos: ⟦{history: KEEP_ALL, reliability: RELIABLE, deadline_ns: 5000000}⟧", "subscriptions").removeprefix("nodl_version: 2\n"), "deadline"),
]  # fmt: skip

PARAMETERS = [
    ("invalid-name", parameter("type: int", name="⟦'a..b'⟧"), "between two dots"),
    ("unusable-name", parameter("type: int", name="gains.⟦__map_joints⟧.p"), "write `map_joints`"),
    ("unusable-name", parameter("type: int", name="⟦__x⟧"), "private in Python"),
    ("unusable-name", parameter("type: int", name="a.⟦__class__⟧"), "cannot be an attribute"),
    ("unusable-name", parameter("type: int", name="a.⟦mro⟧"), "cannot be an attribute"),
    ("unusable-name", parameter("type: int", name="a.⟦frame-id⟧"), "did you mean `a.frame_id`"),
    ("unusable-name", parameter("type: int", name="⟦lambda⟧"), "attribute"),
    ("reserved-parameter", parameter("type: bool", name="⟦use_sim_time⟧"), "rclpy declares"),
    ("reserved-parameter", parameter("type: bool", name="⟦qos_overrides.a⟧"), "rclpy declares"),
    ("value-and-group", "nodl_version: 2\nparameters: {a: {type: int}, ⟦a.b⟧: {type: int}}\n", "group of"),
    ("wrong-value", "nodl_version: 2\nparameters: {a: ⟦5⟧}\n", "a map with the keys"),
    ("missing-key", parameter("default_value: 5").replace("{", "⟦{").replace("}", "}⟧"), "`type`"),
    ("unknown-key", parameter("type: int, ⟦default⟧: 5"), "did you mean `default_value`"),
    ("wrong-value", parameter("type: int, read_only: ⟦1⟧"), "true or false"),
    ("invalid-parameter-type", parameter("type: ⟦float⟧"), "write `double`"),
    ("invalid-parameter-type", parameter("type: ⟦'float[]'⟧"), "write `double_array`"),
    ("invalid-parameter-type", parameter("type: ⟦doubel⟧"), "did you mean `double`"),
    ("invalid-parameter-type", parameter("type: ⟦bool_array_fixed_3⟧"), "fixed_size"),
    ("invalid-parameter-type", parameter("type: ⟦string_fixed_0⟧"), "`string_fixed_N`"),
    ("unknown-key", "nodl_version: 2\nparameters: {pid: {⟦p⟧: {type: double}}}\n", "`pid.p: {type: ...}`"),
    ("wrong-default", parameter("type: int, default_value: ⟦1.5⟧"), "an integer of 64 bits"),
    ("wrong-default", parameter("type: int, default_value: ⟦true⟧"), "boolean true"),
    ("wrong-default", parameter("type: int, default_value: ⟦9223372036854775808⟧"), "64 bits"),
    ("wrong-default", parameter("type: int, default_value: ⟦1e3⟧"), "an integer of 64 bits"),
    ("wrong-default", parameter("type: int, default_value: ⟦1:30⟧"), "base 60"),
    ("wrong-default", parameter("type: string, default_value: ⟦~⟧"), "a text"),
    ("wrong-default", parameter("type: int, default_value: ⟦0o17⟧"), "write `15`"),
    ("wrong-default", parameter("type: string, default_value: ⟦on⟧"), '"on"'),
    ("wrong-default", parameter("type: bool, default_value: ⟦'true'⟧"), "true or false"),
    ("wrong-default", parameter("type: int_array, default_value: ⟦5⟧"), "a list"),
    ("wrong-default", parameter("type: int_array, default_value: [1, ⟦2.5⟧]"), "64 bits"),
    ("wrong-value", parameter("type: byte_array, default_value: [1, ⟦256⟧]"), "0 to 255"),
    ("wrong-default", parameter("type: string_fixed_3, default_value: ⟦four⟧"), "at most 3 characters"),
    ("wrong-default", parameter("type: int_array_fixed_1, default_value: ⟦[1, 2]⟧"), "at most 1 values"),
    ("wrong-default", parameter("type: none, default_value: ⟦1⟧"), "no value"),
    ("wrong-default", parameter(f"type: double, default_value: ⟦1{'0' * 400}⟧"), "can hold"),
]  # fmt: skip

VALIDATORS = [
    ("unknown-validator", "int", "⟦bound⟧: [0, 1]", "did you mean `bounds`"),
    ("unknown-validator", "int", "⟦mine⟧: 1", "my::mine"),
    ("duplicate-validator", "int", "bounds: [0, 1], ⟦bounds<>⟧: [0, 1]", "with and without"),
    ("unfit-validator", "double", "⟦lower_element_bounds⟧: 0.0", "write `gt_eq`"),
    ("unfit-validator", "double_array", "⟦bounds⟧: [0.0, 1.0]", "write `element_bounds`"),
    ("unfit-validator", "string", "⟦gt⟧: 1", "not_empty"),
    ("unfit-validator", "int", "⟦not_empty⟧: []", "the validators that fit are"),
    ("unfit-validator", "none", "⟦one_of⟧: [[1]]", "without a value"),
    ("unfit-validator", "string_array", "⟦element_bounds⟧: [0, 1]", "subset_of"),
    ("invalid-arguments", "int", "bounds: ⟦[1]⟧", "[lower, upper]"),
    ("unfit-argument", "int", "bounds: [0, ⟦1.5⟧]", "64 bits"),
    ("unfit-argument", "int", "bounds: [0, ⟦.inf⟧]", "64 bits"),
    ("unfit-argument", "double", "gt: ⟦.nan⟧", "compare with"),
    ("invalid-arguments", "string", "one_of: ⟦[a, b]⟧", "[[a, b]]"),
    ("unfit-argument", "string", "one_of: [[a, ⟦on⟧]]", '"on"'),
    ("invalid-arguments", "string_array", "unique: ⟦[1]⟧", "nothing"),
    ("invalid-arguments", "string", "size_gt: ⟦-1⟧", "0 or more"),
    ("unfit-argument", "int", "my::check: [⟦{a: 1}⟧]", "boolean"),
    ("empty-bounds", "double", "bounds: ⟦[1.0, 0.0]⟧", "nothing passes"),
    ("mixed-bounds", "double", "⟦gt⟧: 0.0, bounds: [0.0, 1.0]", "one or the other"),
    ("mixed-bounds", "int_array", "element_bounds: [0, 1], ⟦lower_element_bounds⟧: 0", "refuses both"),
    ("missing-function", "int", "⟦my::check⟧: ", "codegen.ifgen"),
    ("wrong-value", "int", "⟦[]⟧", "a map from validators"),
]  # fmt: skip

DEFAULTS = [
    ("double", 2.5, "bounds: [0.0, 1.0]"),
    ("int", 0, "gt: 0"),
    ("int", 5, "lt: 5"),
    ("double", ".nan", "gt_eq: 0.0"),
    ("double", 1.5, "lt_eq: [1]"),
    ("string", "up", "one_of: [[left, right]]"),
    ("bool", "true", "one_of: [[false]]"),
    ("string_array", "[x, w]", "subset_of: [[x, y, z]]"),
    ("int_array", "[1, 1]", "unique: "),
    ("string", "''", "not_empty: []"),
    ("double_array", "[]", "not_empty<>: "),
    ("double_array", "[1.0]", "fixed_size: 2"),
    ("string", "abc", "size_lt: 3"),
    ("byte_array", "[1, 2]", "size_gt: [2]"),
    ("double_array", "[0.5, 1.5]", "element_bounds: [0.0, 1.0]"),
    ("int_array", "[0, -1]", "lower_element_bounds: 0"),
    ("byte_array", "[9]", "upper_element_bounds: 8"),
]

OPTIONS = [
    ("unknown-key", options("⟦styles⟧: asyncio"), "did you mean `style`"),
    ("unknown-value", options("style: ⟦async⟧"), "callbacks, lifecycle, asyncio or nodl"),
    ("wrong-value", options("style: ⟦5⟧"), "one of the texts"),
    ("unknown-value", options("on_type_mismatch: ⟦refused⟧"), "warn, refuse or adapt"),
    ("wrong-value", options("on_type_mismatch: ⟦true⟧"), "one of the texts"),
    ("wrong-value", "nodl_version: 2\ncodegen: {ifgen: ⟦[]⟧}\n", "must be a map"),
    ("wrong-value", options("tests: ⟦contract⟧"), "must be a list"),
    ("unknown-value", options("tests: [contract, ⟦topic⟧]"), "did you mean `topics`"),
    ("invalid-option", options("node_class: ⟦gait-planner⟧"), "a name in Python"),
    ("invalid-option", options("endpoints: {⟦scam⟧: {required: true}}"), "write its name as"),
    ("invalid-option", options("endpoints: {a: {version: ⟦'2.x'⟧}}", CLIENT), "such as 2.1.0"),
    ("invalid-option", options("endpoints: {a: {rate: ⟦0.0⟧}}", CLIENT), "above 0"),
    ("unknown-key", options("endpoints: {a: {⟦require⟧: true}}", CLIENT), "did you mean `required`"),
    ("wrong-value", options("frames: {uses: ⟦map⟧}"), "must be a list"),
    ("invalid-option", options("business_file: ⟦../a.py⟧"), "without a folder"),
    ("invalid-option", options("validators: {'a::b': ⟦check⟧}"), "dotted path"),
    ("wrong-value", options("validators: {'a::b': ⟦5⟧}"), "must be a text"),
    ("missing-key", options("timers: [⟦{rate: 5}⟧]"), "`name`"),
    ("unknown-key", options("timers: [{name: a, rate: 5, ⟦hz⟧: 1}]"), "a timer has no key"),
    ("wrong-value", options("timers: [{name: a, rate: ⟦fast⟧}]"), "a number"),
    ("unknown-value", options("timers: [{name: a, rate: 5, clock: ⟦wall⟧}]"), "ros, steady or system"),
    ("invalid-option", options("timers: [⟦{name: a}⟧]"), "no period"),
    ("invalid-option", options("timers: [⟦{name: a, rate: 1, period: 1}⟧]"), "both `period` and `rate`"),
    ("invalid-option", options("timers: [⟦{name: a, rate: 0}⟧]"), "above 0"),
    ("invalid-option", options("timers: [⟦{name: a, period: .inf}⟧]"), "above 0"),
    ("invalid-option", options("timers: [⟦{name: 1a, period: 1}⟧]"), "a name in Python"),
    ("duplicate-timer", options("timers: [{name: a, rate: 1}, ⟦{name: a, rate: 2}⟧]"), "two timers"),
    ("late-timer", options("timers: [⟦{name: beat, period: 0.2, publishes: [/a]}⟧]", "publishers:\n  - {name: /a, type: std_msgs/String, qos: {history: KEEP_ALL, reliability: RELIABLE, deadline_ns: 100000000}}\n"), "every 0.1 s"),
    ("unknown-parameter", options("timers: [⟦{name: a, period_param: perio}⟧]", A_DOUBLE), "did you mean `period`"),
    ("unknown-parameter", options("timers: [⟦{name: a, period_param: count}⟧]", A_DOUBLE), "must be a double"),
    ("unknown-publisher", options("timers: [⟦{name: a, rate: 1, publishes: [/b]}⟧]"), "no publishers"),
    ("same-module", options("business_file: msg.py").replace("nodl_v", "⟦⟧nodl_v"), "hide another"),
]  # fmt: skip


def as_validator(rule: str, type_: str, validators: str, said: str) -> tuple[str, str, str]:
    """A case with a parameter that has these validators."""
    inside = validators if validators.startswith("⟦[") else f"{{{validators}}}"
    return rule, parameter(f"type: {type_}, validation: {inside}"), said


ALL = [*SYNTAX, *DOCUMENT, *ENDPOINTS, *PARAMETERS, *(as_validator(*case) for case in VALIDATORS), *OPTIONS]
ALL += [(rule, options(text), said) for rule, text, said in STRUCTS]


@pytest.mark.parametrize(
    ("rule", "text", "said"), ALL, ids=[f"{rule}-{i}" for i, (rule, _, _) in enumerate(ALL)]
)
def test_a_mistake_is_reported_once_and_there(load_nodes: Load, rule: str, text: str, said: str) -> None:
    """There is one diagnostic, of this rule, at the mark; its message or help says what to do."""
    start, end = text.index("⟦"), text.index("⟧") - 1
    text = text.replace("⟦", "").replace("⟧", "")
    loaded = load_nodes({"demo/nodl/talker.nodl.yaml": text, "demo/nodl/part.nodl.yaml": "nodl_version: 2"})
    assert loaded.rules == [rule], [(d.rule, d.message, d.help) for d in loaded.diagnostics]
    [found] = loaded.diagnostics
    assert found.primary is not None
    span = found.primary.span
    assert (span.source.text[span.start : span.end].rstrip(), span.start) == (text[start:end].rstrip(), start)
    words = " ".join((found.message, found.primary.text, found.help or ""))
    assert said in words, words
    assert not found.message.endswith(".")


@pytest.mark.parametrize(("type_", "default", "validator"), DEFAULTS)
def test_a_default_passes_its_own_validators(
    load_nodes: Load, type_: str, default: object, validator: str
) -> None:
    """A default that a validator would refuse is an error that shows both."""
    text = parameter(f"type: {type_}, default_value: {default}, validation: {{{validator}}}")
    [found] = load_nodes(text).diagnostics
    assert found.rule == "rejected-default"
    assert found.primary is not None
    assert found.primary.span.source.text[found.primary.span.start :].startswith(str(default))
    assert found.secondary[0].span.line == found.primary.span.line


def rules_of(load_nodes: Load, text: str) -> list[str]:
    return sorted(found.rule for found in load_nodes(text).diagnostics)


def test_every_mistake_below_codegen_ifgen_is_found_in_one_run(load_nodes: Load) -> None:
    """A wrong value hides neither its other mistakes nor conflicts with the rest of the node."""
    text = (
        "nodl_version: 2\n"
        "codegen:\n  ifgen:\n"
        "    style: async\n"
        "    node_class: a-b\n"
        "    validators: {'a::b': 5}\n"
        "    tests: [topic]\n"
        "    timers:\n"
        "      - {rate: fast, publishes: [nothing]}\n"
        "      - 5\n"
        "      - {name: 1a, rate: 0}\n"
        "      - {name: a, period_param: nope, publishes: [~/b, 7]}\n"
        "      - {name: a, clock: wall}\n"
        "      - {period: 1, rate: 1}\n"
        "parameters:\n"
        "  p: {type: int, validation: {'a::b': 1, 'c::d': 1}}\n"
        "publishers:\n"
        "  - {name: ~/b, type: std_msgs/Strin, qos: {history: KEEP_ALL, reliability: RELIABLE}}\n"
    )
    assert rules_of(load_nodes, text) == [
        "duplicate-timer",  # a
        "invalid-option",  # node_class
        "invalid-option",  # 1a
        "invalid-option",  # no rate above 0
        "invalid-option",  # the second timer a has no period
        "invalid-option",  # period and rate
        "missing-function",  # c::d; that of a::b is there, but wrong
        "missing-key",  # the first timer has no name
        "missing-key",  # nor has the last
        "unknown-parameter",  # nope
        "unknown-publisher",  # nothing; ~/b is there, but wrong
        "unknown-type",
        "unknown-value",  # style
        "unknown-value",  # tests
        "unknown-value",  # clock
        "wrong-value",  # the function of a::b
        "wrong-value",  # rate
        "wrong-value",  # a timer that is 5
        "wrong-value",  # 7
    ]


@pytest.mark.parametrize(
    "unclear",
    [
        "publishers: 5\nparameters: 5\n",
        "publishers: [{type: std_msgs/String}]\nparameters: []\n",
        "include: [{ref: 'local://nobody.nodl.yaml'}]\n",
        "include: [{ref: 'local://broken.nodl.yaml'}]\n",
        "include: [{ref: 'local://latin1.nodl.yaml'}]\n",
    ],
)
def test_what_may_have_been_left_out_is_not_missed(load_nodes: Load, unclear: str) -> None:
    timer = "timers: [{name: a, period_param: nope, publishes: [nothing]}]"
    loaded = load_nodes(
        {
            "demo/nodl/talker.nodl.yaml": options(timer, unclear),
            "demo/nodl/broken.nodl.yaml": "parameters: {nope: [",
            "demo/nodl/latin1.nodl.yaml": b"description: \xe9",
        }
    )
    assert loaded.rules
    assert not {"unknown-parameter", "unknown-publisher"} & set(loaded.rules)
