"""Documents at the edges of NoDL 2: YAML's forms, JSON Schema's integers, null members, names, arguments.

What upstream says of them was worked out from its schema, with jsonschema and PyYAML's safe_load.
"""

from __future__ import annotations

from typing import Final

V: Final = "nodl_version: 2\n"

ACCEPTED: Final = [
    "\ufeffnodl_version: 2\n",
    "nodl_version: 2\r\ndescription: a\r\n",
    "%YAML 1.1\n---\nnodl_version: 2\n",
    "%YAML 1.2\n---\nnodl_version: 2\n",
    "---\nnodl_version: 2\n...\n",
    "--- {nodl_version: 2}",
    "{nodl_version: 2}",
    '{"nodl_version": 2}',
    '{"nodl_version":2}',
    "nodl_version: 2.0\n",
    "nodl_version: 0x2\n",
    "nodl_version: +2\n",
    "nodl_version: 02\n",
    "nodl_version: 0b10\n",
    V + "description: |\n  a\n  b\n",
    V + "description: >-\n  a\n",
    V + "description: ''\n",
    V + "description: 'null'\n",
    V + "description: y\n",
    V + "description: 1e3\n",
    V + "description: 1.e3\n",
    V + "description: 1.0e3\n",
    V + "description: Infinity\n",
    V + "description: 0o17\n",
    V + "description: a #b\n",
    V + 'description: "\\x41"\n',
    V + 'description: "\\/"\n',
    V + "description: '\U0001f600'\n",
    V
    + "publishers:\n- &a {name: a, type: std_msgs/String, qos: {history: KEEP_LAST, depth: 1, reliability: RELIABLE}}\nsubscriptions:\n- *a\n",
    V
    + "publishers:\n- {name: a, type: std_msgs/String, qos: &q {history: KEEP_ALL, reliability: RELIABLE}}\n- {name: b, type: std_msgs/String, qos: {<<: *q, depth: 5}}\n",
    V
    + "publishers:\n- {name: b, type: std_msgs/String, qos: {<<: [{history: KEEP_ALL}, {reliability: RELIABLE}]}}\n",
    V
    + "publishers:\n- {name: b, type: std_msgs/String, qos: {<<: {}, history: KEEP_ALL, reliability: RELIABLE}}\n",
    V + "parameters: {a: {type: int, default_value: }}\n",
    V + "parameters: {a: {type: int, default_value: null}}\n",
    V + "parameters: {a: {type: bool, default_value: on}}\n",
    V + "parameters: {a: {type: int, default_value: {b: 1}}}\n",
    V + "parameters: {a: {type: int, default_value: 2020-01-01}}\n",
    V + "parameters: {a: {type: none, default_value: 5}}\n",
    V + "parameters: {'1': {type: int}}\n",
    V + "parameters: {a b: {type: int}}\n",
    V + "parameters: {a: {type: bool_array, default_value: []}}\n",
    V + "parameters: {a: {type: string, default_value: 5}}\n",
    V + "parameters: {a: {type: byte_array}}\n",
    V + "parameters: {a: {type: byte_array, default_value: []}}\n",
    V + "parameters: {a: {type: int, validation: {bounds: [5, 1]}}}\n",
    V + "parameters: {a: {type: int, validation: {lt: 1.0e+3}}}\n",
    V + "parameters: {a: {type: int, validation: {one_of: [[null]]}}}\n",
    V + "parameters: {a: {type: int, validation: {unique: []}}}\n",
    V + "parameters: {a: {type: int, validation: {fixed_size: 3.0}}}\n",
    V + "parameters: {a: {type: string, validation: {fixed_size: 3.0}}}\n",
    V + "parameters: {a: {type: string, validation: {'unique<>': }}}\n",
    V + "codegen: {a: {b: 2020-01-01}}\n",
    V + "codegen: {a: {b: .nan}}\n",
    V + "service_servers: [{name: a, type: std_srvs/msg/Trigger}]\n",
    V + "action_servers: [{name: a, type: std_srvs/msg/Trigger}]\n",
    V + "service_servers: [{name: y, type: std_srvs/Trigger}]\n",
    V + "service_servers: [{name: 'on', type: std_srvs/Trigger}]\n",
    V + "service_servers: [{name: ~a, type: std_srvs/Trigger}]\n",
    V + "service_servers: [{name: a, type: std_srvs/Trigger}, {name: /a, type: std_srvs/Trigger}]\n",
    V + "service_servers: [{name: a__b, type: std_srvs/Trigger}]\n",
    V + "service_servers: [{name: a_, type: std_srvs/Trigger}]\n",
    V + "service_servers: [{name: /_a, type: std_srvs/Trigger}]\n",
    V + "service_servers: [{name: //a, type: std_srvs/Trigger}]\n",
    V + "service_servers: [{name: a, type: a__b/Trigger}]\n",
    V
    + "service_servers: [{name: a, type: std_srvs/Trigger, qos: {history: KEEP_LAST, depth: 1.0, reliability: RELIABLE}}]\n",
    V
    + "service_servers: [{name: a, type: std_srvs/Trigger, qos: {history: KEEP_ALL, reliability: RELIABLE, deadline_ns: 1.0e+9}}]\n",
    V
    + "service_servers: [{name: a, type: std_srvs/Trigger, qos: {history: KEEP_ALL, reliability: RELIABLE, deadline_ns: 1_000}}]\n",
    "nodl_version: 2 # x\n",
]

REFUSED: Final = [
    ("unknown-key", V + "base: x"),
    ("unknown-key", V + "fragments: []"),
    ("unknown-key", V + "name: talker"),
    ("unknown-key", V + "x-more: 1"),
    ("wrong-value", V + "description: 5"),
    ("wrong-value", V + "description:"),
    ("wrong-value", V + "codegen: text"),
    ("wrong-value", V + "codegen: {cpp: text}"),
    ("wrong-value", V + "codegen: {cpp: }"),
    ("wrong-value", V + "include: text"),
    ("wrong-value", V + "include: [text]"),
    ("missing-key", V + "include: [{}]"),
    ("invalid-include", V + "include: [{ref: ''}]"),
    ("invalid-include", V + "include: [{ref: '/abs/path'}]"),
    ("invalid-include", V + "include: [{ref: 'a/b.yaml'}]"),
    ("invalid-include", V + "include: [{ref: './a'}]"),
    ("invalid-include", V + "include: [{ref: '://x'}]"),
    ("invalid-include", V + "include: [{ref: 'has space://x'}]"),
    ("invalid-include", V + "include: [{ref: 'Nodl://a/b'}]"),
    ("wrong-value", V + "parameters: []"),
    ("wrong-value", V + "parameters: {p: int}"),
    ("missing-key", V + "parameters: {p: {description: x}}"),
    ("invalid-parameter-type", V + "parameters: {p: {type: float}}"),
    ("invalid-parameter-type", V + "parameters: {p: {type: bool_array_fixed_3}}"),
    ("invalid-parameter-type", V + "parameters: {p: {type: string_fixed_0}}"),
    ("invalid-parameter-type", V + "parameters: {p: {type: string_fixed_04}}"),
    ("wrong-value", V + "parameters: {p: {type: int, read_only: 1}}"),
    ("unknown-key", V + "parameters: {p: {type: int, unit: m}}"),
    ("wrong-value", V + "parameters: {p: {type: byte_array, default_value: [-1]}}"),
    ("wrong-value", V + "parameters: {p: {type: byte_array, default_value: [256]}}"),
    ("invalid-name", V + "parameters: {a..b: {type: int}}"),
    ("invalid-name", V + "parameters: {'.a': {type: int}}"),
    ("value-and-group", V + "parameters: {a: {type: int}, a.b: {type: int}}"),
    ("invalid-arguments", V + "parameters: {p: {type: int, validation: {bounds: [0]}}}"),
    ("invalid-arguments", V + "parameters: {p: {type: int, validation: {bounds: 5}}}"),
    ("invalid-arguments", V + "parameters: {p: {type: int, validation: {lt: x}}}"),
    ("invalid-arguments", V + "parameters: {p: {type: int, validation: {lt: [1, 2]}}}"),
    ("unknown-validator", V + "parameters: {p: {type: int, validation: {maximum: 5}}}"),
    ("invalid-arguments", V + "parameters: {p: {type: int, validation: {one_of: [1, 2]}}}"),
    ("invalid-arguments", V + "parameters: {p: {type: int, validation: {one_of: [[]]}}}"),
    ("yaml-syntax", V + "parameters: {p: {type: int, validation: {::b: 5}}}"),
    ("invalid-arguments", V + "parameters: {p: {type: int, validation: {a::b: {x: 1}}}}"),
    ("number-as-text", V + "parameters: {p: {type: double, validation: {gt: 1e3}}}"),
    ("invalid-arguments", V + "parameters: {p: {type: string, validation: {size_gt: -1}}}"),
    ("invalid-arguments", V + "parameters: {p: {type: string, validation: {size_gt: 1.5}}}"),
    ("invalid-arguments", V + "parameters: {p: {type: string, validation: {not_empty: 5}}}"),
    (
        "invalid-name",
        V
        + "publishers: [{name: '', type: std_msgs/msg/String, qos: {history: KEEP_LAST, depth: 1, reliability: RELIABLE}}]",
    ),
    (
        "invalid-name",
        V
        + "publishers: [{name: '1a', type: std_msgs/msg/String, qos: {history: KEEP_LAST, depth: 1, reliability: RELIABLE}}]",
    ),
    (
        "invalid-name",
        V
        + "publishers: [{name: 'a/', type: std_msgs/msg/String, qos: {history: KEEP_LAST, depth: 1, reliability: RELIABLE}}]",
    ),
    (
        "invalid-name",
        V
        + "publishers: [{name: '/', type: std_msgs/msg/String, qos: {history: KEEP_LAST, depth: 1, reliability: RELIABLE}}]",
    ),
    (
        "invalid-name",
        V
        + "publishers: [{name: '~', type: std_msgs/msg/String, qos: {history: KEEP_LAST, depth: 1, reliability: RELIABLE}}]",
    ),
    (
        "invalid-name",
        V
        + "publishers: [{name: 'a-b', type: std_msgs/msg/String, qos: {history: KEEP_LAST, depth: 1, reliability: RELIABLE}}]",
    ),
    (
        "invalid-name",
        V
        + "publishers: [{name: 'a b', type: std_msgs/msg/String, qos: {history: KEEP_LAST, depth: 1, reliability: RELIABLE}}]",
    ),
    (
        "invalid-name",
        V
        + "publishers: [{name: '/a/{x}', type: std_msgs/msg/String, qos: {history: KEEP_LAST, depth: 1, reliability: RELIABLE}}]",
    ),
    (
        "invalid-type",
        V
        + "publishers: [{name: '/a', type: String, qos: {history: KEEP_LAST, depth: 1, reliability: RELIABLE}}]",
    ),
    (
        "invalid-type",
        V
        + "publishers: [{name: '/a', type: std_msgs//String, qos: {history: KEEP_LAST, depth: 1, reliability: RELIABLE}}]",
    ),
    (
        "invalid-type",
        V
        + "publishers: [{name: '/a', type: std_msgs/msg/string, qos: {history: KEEP_LAST, depth: 1, reliability: RELIABLE}}]",
    ),
    (
        "invalid-type",
        V
        + "publishers: [{name: '/a', type: std_msgs/idl/String, qos: {history: KEEP_LAST, depth: 1, reliability: RELIABLE}}]",
    ),
    (
        "invalid-type",
        V
        + "publishers: [{name: '/a', type: std_msgs/msg/A_B, qos: {history: KEEP_LAST, depth: 1, reliability: RELIABLE}}]",
    ),
    (
        "invalid-type",
        V
        + "publishers: [{name: '/a', type: std_msgs/msg/String/x, qos: {history: KEEP_LAST, depth: 1, reliability: RELIABLE}}]",
    ),
    (
        "invalid-type",
        V
        + "publishers: [{name: '/a', type: 1a/msg/A, qos: {history: KEEP_LAST, depth: 1, reliability: RELIABLE}}]",
    ),
    ("wrong-value", V + "publishers: {a: b}"),
    (
        "unknown-key",
        V
        + "publishers: [{name: a, type: std_msgs/msg/String, qos: {history: KEEP_LAST, depth: 1, reliability: RELIABLE}, unit: m}]",
    ),
    ("missing-key", V + "publishers: [{name: a, type: std_msgs/msg/String}]"),
    (
        "missing-key",
        V
        + "publishers: [{type: std_msgs/msg/String, qos: {history: KEEP_LAST, depth: 1, reliability: RELIABLE}}]",
    ),
    (
        "missing-key",
        V + "publishers: [{name: a, qos: {history: KEEP_LAST, depth: 1, reliability: RELIABLE}}]",
    ),
    (
        "duplicate-endpoint",
        V
        + "publishers: [{name: /a, type: std_msgs/msg/String, qos: {history: KEEP_LAST, depth: 1, reliability: RELIABLE}}, {name: /a, type: std_msgs/msg/String, qos: {history: KEEP_LAST, depth: 1, reliability: RELIABLE}}]",
    ),
    (
        "missing-key",
        V
        + "publishers: [{name: '/a', type: std_msgs/msg/String, qos: {history: KEEP_LAST, reliability: RELIABLE}}]",
    ),
    (
        "wrong-value",
        V
        + "publishers: [{name: '/a', type: std_msgs/msg/String, qos: {history: KEEP_LAST, depth: 0, reliability: RELIABLE}}]",
    ),
    (
        "unknown-value",
        V
        + "publishers: [{name: '/a', type: std_msgs/msg/String, qos: {history: BEST_AVAILABLE, reliability: RELIABLE}}]",
    ),
    (
        "unknown-value",
        V
        + "publishers: [{name: '/a', type: std_msgs/msg/String, qos: {history: keep_all, reliability: RELIABLE}}]",
    ),
    (
        "missing-key",
        V + "publishers: [{name: '/a', type: std_msgs/msg/String, qos: {reliability: RELIABLE}}]",
    ),
    ("missing-key", V + "publishers: [{name: '/a', type: std_msgs/msg/String, qos: {history: KEEP_ALL}}]"),
    (
        "unknown-value",
        V
        + "publishers: [{name: '/a', type: std_msgs/msg/String, qos: {history: KEEP_ALL, reliability: UNKNOWN}}]",
    ),
    (
        "wrong-value",
        V
        + "publishers: [{name: '/a', type: std_msgs/msg/String, qos: {history: KEEP_ALL, reliability: RELIABLE, deadline_ns: -1}}]",
    ),
    (
        "wrong-value",
        V
        + "publishers: [{name: '/a', type: std_msgs/msg/String, qos: {history: KEEP_ALL, reliability: RELIABLE, deadline_ns: 1.5}}]",
    ),
    (
        "unknown-key",
        V
        + "publishers: [{name: '/a', type: std_msgs/msg/String, qos: {history: KEEP_ALL, reliability: RELIABLE, deadline: 1}}]",
    ),
    ("missing-key", V + "service_servers: [{name: a}]"),
    (
        "unknown-key",
        V
        + "action_servers: [{name: a, type: example_interfaces/action/Fibonacci, qos: {history: KEEP_LAST, depth: 1, reliability: RELIABLE}}]",
    ),
    ("yaml-syntax", '{\n\t"nodl_version": 2\n}'),
    ("nodl-version", "nodl_version: 2e0\n"),
    ("wrong-value", V + "description: ! 5\n"),
    ("wrong-value", V + "description: null\n"),
    ("wrong-value", V + "description: ~\n"),
    ("yaml-syntax", V + "description: =\n"),
    ("wrong-value", V + "description: 1_000\n"),
    ("wrong-value", V + "description: 1:30\n"),
    ("wrong-value", V + "description: 2020-01-01\n"),
    ("wrong-value", V + "description: yes\n"),
    ("wrong-value", V + "description: .5\n"),
    ("wrong-value", V + "description: 5.\n"),
    ("wrong-value", V + "description: .inf\n"),
    ("yaml-syntax", V + "description: <<\n"),
    ("yaml-syntax", V + "description: a: b\n"),
    ("yaml-syntax", V + "description: a\x85b\n"),
    ("yaml-syntax", V + "description: a\u2028b\n"),
    (
        "unknown-key",
        V
        + "publishers:\n- {name: b, type: std_msgs/String, qos: {'<<': {}, history: KEEP_ALL, reliability: RELIABLE}}\n",
    ),
    ("unknown-key", V + "x: &x 5\n"),
    ("no-text-key", V + "parameters: {on: {type: int}}\n"),
    ("no-text-key", V + "parameters: {1: {type: int}}\n"),
    ("invalid-name", V + "parameters: {'': {type: int}}\n"),
    ("no-text-key", V + "parameters: {1.5: {type: int}}\n"),
    ("no-text-key", V + "parameters: {null: {type: int}}\n"),
    ("wrong-value", V + "parameters: {a: {type: byte_array, default_value: null}}\n"),
    ("wrong-value", V + "parameters: {a: {type: byte_array, default_value: [true]}}\n"),
    ("wrong-value", V + "parameters: {a: {type: byte_array, default_value: '00'}}\n"),
    ("invalid-parameter-type", V + "parameters: {a: {type: Int}}\n"),
    ("invalid-arguments", V + "parameters: {a: {type: int, validation: {bounds: [0, 1, 2]}}}\n"),
    ("invalid-arguments", V + "parameters: {a: {type: int, validation: {lt: true}}}\n"),
    ("invalid-arguments", V + "parameters: {a: {type: int, validation: {lt: [true]}}}\n"),
    ("number-as-text", V + "parameters: {a: {type: int, validation: {lt: 1e3}}}\n"),
    ("invalid-arguments", V + "parameters: {a: {type: int, validation: {one_of: [[1], [2]]}}}\n"),
    ("invalid-arguments", V + "parameters: {a: {type: int, validation: {unique: {}}}}\n"),
    ("invalid-arguments", V + "parameters: {a: {type: int, validation: {unique: ''}}}\n"),
    ("invalid-arguments", V + "parameters: {a: {type: string, validation: {fixed_size: [3.5]}}}\n"),
    ("unknown-validator", V + "parameters: {a: {type: string, validation: {'a::b<>': 5}}}\n"),
    ("unknown-validator", V + "parameters: {a: {type: string, validation: {'a:b': 5}}}\n"),
    ("invalid-arguments", V + "parameters: {a: {type: string, validation: {'a::b': 2020-01-01}}}\n"),
    ("unknown-validator", V + "parameters: {a: {type: string, validation: {'a::1': 5}}}\n"),
    ("invalid-arguments", V + "parameters: {a: {type: string, validation: {'bounds<>': }}}\n"),
    ("wrong-value", V + "include: [{ref: 5}]\n"),
    ("wrong-value", V + "include: [{ref: null}]\n"),
    ("wrong-value", V + "include: {ref: 'x://y'}\n"),
    ("wrong-value", V + "codegen: null\n"),
    ("wrong-value", V + "codegen: []\n"),
    ("wrong-value", V + "codegen: {a: []}\n"),
    ("no-text-key", V + "codegen: {a: {? [1]: 2}}\n"),
    ("wrong-value", V + "publishers:\n"),
    ("wrong-value", V + "publishers: null\n"),
    ("wrong-value", V + "publishers: [null]\n"),
    ("wrong-value", V + "parameters: null\n"),
    ("wrong-value", V + "parameters: {a: null}\n"),
    ("wrong-value", V + "service_servers: [{name: a, type: std_srvs/Trigger, qos: null}]\n"),
    ("wrong-value", V + "service_servers: [{name: a, type: std_srvs/Trigger, description: null}]\n"),
    ("wrong-value", V + "service_servers: [{name: on, type: std_srvs/Trigger}]\n"),
    ("wrong-value", V + "service_servers: [{name: ~, type: std_srvs/Trigger}]\n"),
    (
        "duplicate-endpoint",
        V + "service_servers: [{name: a, type: std_srvs/Trigger}, {name: a, type: std_srvs/Empty}]\n",
    ),
    ("invalid-name", V + "service_servers: [{name: ~~a, type: std_srvs/Trigger}]\n"),
    ("invalid-name", V + "service_servers: [{name: ~/, type: std_srvs/Trigger}]\n"),
    ("invalid-name", V + "service_servers: [{name: \xe9, type: std_srvs/Trigger}]\n"),
    ("invalid-type", V + "service_servers: [{name: a, type: std_srvs/srv/srv/Trigger}]\n"),
    ("invalid-type", V + "service_servers: [{name: a, type: _a/Trigger}]\n"),
    ("invalid-type", V + "service_servers: [{name: a, type: std_srvs.Trigger}]\n"),
    (
        "wrong-value",
        V
        + "service_servers: [{name: a, type: std_srvs/Trigger, qos: {history: KEEP_LAST, depth: true, reliability: RELIABLE}}]\n",
    ),
    (
        "wrong-value",
        V
        + "service_servers: [{name: a, type: std_srvs/Trigger, qos: {history: KEEP_LAST, depth: '1', reliability: RELIABLE}}]\n",
    ),
    (
        "wrong-value",
        V
        + "service_servers: [{name: a, type: std_srvs/Trigger, qos: {history: KEEP_LAST, depth: null, reliability: RELIABLE}}]\n",
    ),
    (
        "wrong-value",
        V
        + "service_servers: [{name: a, type: std_srvs/Trigger, qos: {history: KEEP_ALL, depth: 0, reliability: RELIABLE}}]\n",
    ),
    (
        "wrong-value",
        V
        + "service_servers: [{name: a, type: std_srvs/Trigger, qos: {history: KEEP_ALL, reliability: RELIABLE, deadline_ns: 1e9}}]\n",
    ),
    (
        "wrong-value",
        V
        + "service_servers: [{name: a, type: std_srvs/Trigger, qos: {history: KEEP_ALL, reliability: RELIABLE, deadline_ns: .inf}}]\n",
    ),
    (
        "wrong-value",
        V
        + "service_servers: [{name: a, type: std_srvs/Trigger, qos: {history: KEEP_ALL, reliability: RELIABLE, durability: null}}]\n",
    ),
    ("missing-key", V + "service_servers: [{name: a, type: std_srvs/Trigger, qos: {}}]\n"),
    ("no-text-key", V + "1: 2\n"),
    ("unknown-key", V + "? a\n"),
    ("wrong-value", "a"),
    ("empty-document", ""),
    ("empty-document", "# c\n"),
    ("wrong-value", "[]"),
    ("wrong-value", "2"),
    ("several-documents", V + "---\n"),
    ("several-documents", V + "...\n---\n"),
    ("nodl-version", "nodl_version: [2]\n"),
    ("unknown-anchor", V + "description: *x\n"),
    ("yaml-syntax", V + "\tdescription: a\n"),
    ("yaml-syntax", V + "codegen: {a:\t{}}\n"),
    ("wrong-value", "nodl_version:2\n"),
    ("yaml-syntax", V + "description: '\n"),
    ("yaml-syntax", V + "description: @a\n"),
    ("yaml-syntax", V + "description: `a`\n"),
    ("yaml-syntax", V + "description: %a\n"),
    ("yaml-syntax", V + "description: -\n"),
    ("yaml-syntax", V + "description: ?\n"),
]
"""The rule of the first error, and the document."""

STRICTER: Final = [
    ("yaml-tag", "nodl_version: !!int 2\n"),
    ("yaml-tag", "nodl_version: !!int '2'\n"),
    ("yaml-tag", "!!map {nodl_version: 2}\n"),
    ("yaml-tag", V + "description: !!str x\n"),
    ("yaml-tag", V + "description: !!str 5\n"),
    ("duplicate-key", V + "nodl_version: 2\n"),
    ("invalid-text", V + 'description: "\\ud83d\\ude00"\n'),
    ("unclear-number", V + "parameters: {a: {type: int, default_value: 010}}\n"),
    ("duplicate-key", V + "parameters: {a: {type: int}, a: {type: int}}\n"),
    ("no-text-key", V + "codegen: {5: {}}\n"),
    ("no-text-key", V + "codegen: {a: {5: 6}}\n"),
    ("yaml-tag", V + "codegen: {a: {b: !!set {x, y}}}\n"),
    ("invalid-name", V + 'service_servers: [{name: "a\\n", type: std_srvs/Trigger}]\n'),
    ("unknown-anchor", V + "codegen: {a: &a {b: *a}}\n"),
    ("invalid-text", V + 'description: "a\\0b"\n'),
    ("invalid-text", V + 'description: "\\ud800"\n'),
]
"""Documents that upstream accepts and ifgen refuses, by rules that docs/nodl.md lists."""
