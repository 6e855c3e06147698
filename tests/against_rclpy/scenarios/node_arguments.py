"""`--ros-args` in all its forms: names of nodes, remapped names, parameter overrides, and the errors."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path
from typing import Any

import rclpy
from rclpy.context import Context
from rclpy.utilities import remove_ros_args
from transcript import attempt

ROS = "--ros-args"
TOPICS = ("chatter", "/abs/chatter", "srv")

REMAP_RULES = [
    "chatter:=t",
    "bad",
    "a:=b:=c",
    ":=b",
    "a:=",
    "__node:=m",
    "__name:=m",
    "__ns:=/s",
    "__ns:=s",
    "__node:=m/x",
    "n:__node:=m",
    "x:__node:=m",
    "n:__ns:=/q",
    "n:chatter:=t",
    "x:chatter:=t",
    "rostopic://chatter:=t",
    "rosservice://chatter:=t",
    "chatter:=rosservice://t",
    "*:=t",
    "**:=t",
    "/**/chatter:=t",
    "chatter:=**",
    "/*/chatter:=/\\1/t",
    "chatter:=~/t",
    "~/chatter:=t",
    "/chatter:=/t",
    "chatter:={node}/t",
    "{node}:=t",
    "chatter:=1a",
    "__foo:=c",
    "chatter:=__foo",
    "n:n2:chatter:=t",
    "n:rostopic://chatter:=t",
    "rostopic://n:chatter:=t",
    "/n:chatter:=t",
    "__node:=__m",
    "__node:=",
    "__ns:=",
    "__ns:=/",
    "__ns:=~/x",
    "__node:=1m",
    "__ns:=/1",
    "__ns:=/a//b",
    "chatter:=/t/",
    "chatter:=t/",
    "chatter:=//t",
    "chatter:=~",
    "chatter:=~t",
    "~:=t",
    "/:=t",
    "chatter:=/",
    "ch~:=t",
    "chatter=t",
    "a__b:=z",
    "_a:=z",
    "_:=z",
    "a_:=z",
    "a__:=z",
    "__a:=z",
    "a___b:=z",
    "__:=z",
    "__nodex:=z",
    "__nsx:=z",
    "__n:=z",
    "a/__b:=z",
    "rostopic://:=z",
    "a.b:=z",
    "~/:=z",
    "~/__ns:=z",
    "é:=z",
    "\\1:=z",
    "a:=a__b",
    "a:=_",
    "a:=\\1",
    "a:=a/\\1",
    "a:=a.b",
    "a:=a:b",
    "a:=rostopic:/a",
]

PARAMETER_NAMES = [
    "a",
    "a:",
    "b:a:=1",
    "n:a:=1",
    "/b:a:=1",
    "b/c:a:=1",
    "/**:a:=1",
    "**:a:=1",
    "*:a:=1",
    "a.b:=1",
    "a/b:=1",
    ".a:=1",
    "a.:=1",
    "a..b:=1",
    "n:a.b:=1",
    "1a:=1",
    "a1:=1",
    "a-b:=1",
    "n::a:=1",
    ":a:=1",
    "n:=:=1",
    "a:=1:=2",
    "~/a:=1",
    "__a:=1",
    "a.*:=1",
    "*:=1",
    "/a:=1",
    "a/:=1",
    "n:m:a:=1",
    "x__y:=1",
    "rostopic://a:=1",
    "__node:=1",
    "a.1:=1",
]

VALUES = [
    *["1", "1.0", ".5", "1.", "-1", "+1", "0x10", "0X1F", "0o17", "017", "08", "1e3", "1.e3", "1e-3", "true", "True", "tRue", "yes", "no", "on", "off", "y", "n", "null", "~", '"1"', "[1,2]", "[1.0,2]", "[1,2.0]", "[1,a]", "[a,b]", "[true,false]", "[true,1]", "[]", "[[1]]", "[[1],[2]]", "[[1],2]", "[1,[2]]", "{}", "nan", ".nan", "-.nan", ".NaN", "inf", ".inf", "-.inf", ".iNf", "1_000", "99999999999999999999", "9223372036854775807", "9223372036854775808", "-9223372036854775808", "*a", "2001-01-01", "1:30", "0b11", "[null]", "1.5.2", "1.2e", "-", "--", ".", "..", "1f", "infinity", "-inf", "1e400", "1e-310", "0x", "-0x10", "1e+3", "[1,]", "[1", "a]", "]", '"a', "%a", "@a", "[1.0,]", "''", "1,", "?", "0.", "00", "1E5", "0x1p3", "0x1.8", "nan(1)", "0x8000000000000000", "++1", "0777777777777777777777777", "/x/y.z", "a/b"],
    "", "a b", "'a b'", "{a: 1}", "!!str 1", '!!int "1"', "&a 1", "a: b", "a #c", "#c", '"a\\nb"', "- 1", "|\n a", "|\n 1", "|\n", ">\n yes", '[1, "2"]',
    "!!binary aGk=", "!!bool 1", " 1", "1 ", "\t1", "! 1", "1\n---\n2",
]  # fmt: skip

COMMAND_LINES: list[list[str]] = [
    [], ["a"], [ROS], [ROS, "--"], [ROS, "-r"], [ROS, "--remap"], [ROS, "--remap", "chatter:=t"], [ROS, "-r", "a b:=c"],
    [ROS, "-r", ""], [ROS, "-r", "chatter:=t", "-r", "chatter:=u"], [ROS, "-r", "chatter:=u", "-r", "u:=v"],
    [ROS, "-r", "__node:=x", "-r", "__node:=y"], [ROS, "-r", "__node:=x", "-r", "x:__ns:=/y"],
    [ROS, "-r", "__node:=x", "-r", "n:__ns:=/y"], [ROS, "-r", "__node:=m", "-r", "m:chatter:=x", "-r", "n:srv:=y"],
    [ROS, "--nope"], [ROS, "--nope", "x"], [ROS, "x"], [ROS, "--", "--nope"], ["--nope"], ["chatter:=t"], ["__node:=m"],
    ["__ns:=/z"], ["n:chatter:=t"], ["__params:=/nope"], ["__log_level:=nope"], ["_p:=1"], ["foo:=1 2"],
    [ROS, "-p"], [ROS, "--param"], [ROS, "--param", "a:=1"], [ROS, "--log-level"], [ROS, "--log-level", "nope"],
    [ROS, "--log-level", "WARN"], [ROS, "--log-level", "n:=warn"], [ROS, "--log-level", "n:=nope"],
    [ROS, "--log-level", "a:=b:=info"], [ROS, "--log-level", ":=info"], [ROS, "--log-level", "n:="],
    [ROS, "--log-level", ""], [ROS, "--log-level", "10"], [ROS, "--log-level", "a/b:=warn"], [ROS, "-e", "/x"],
    [ROS, "--enclave", "/x"], [ROS, "-e", "x"], [ROS, "-e"], [ROS, "-e", "/a b"], [ROS, "-e", "/x", "-e", "/y"],
    [ROS, "--enable-rosout-logs"], [ROS, "--disable-rosout-logs"], [ROS, "--enable-stdout-logs"],
    [ROS, "--disable-external-lib-logs"], [ROS, "--enable-foo-logs"], [ROS, "--log-config-file", "/nope"],
    [ROS, "--log-config-file"], [ROS, "--log-file-name", "x"], [ROS, "--log-file-name"], [ROS, "--params-file"],
    [ROS, "--params-file", "/nope.yaml"], [ROS, "-r", "chatter:=t", "--", "-r", "x:=y"],
    ["a", ROS, "-r", "chatter:=t", ROS, "-r", "srv:=y"],
]  # fmt: skip

P = "ros__parameters"
# (file texts, arguments before the files, arguments after, node, namespace)
FILES: list[tuple[list[str], list[str], list[str], str, str]] = [
    *(
        ([f'"{pattern}": {{{P}: {{a: 1}}}}\n'], [], [], "n", namespace)
        for pattern in ["n", "/n", "/**", "/*", "q/n", "/q/n", "/q/*", "/*/n", "/**/n", "/q/**", "/**/r/*", "/q*", "n*", "/*/**", "/**/**", "//n", "n/", "/", "1n", "/***", "a//n", "///n", "**", "*/n", "/n/**", "n/**", "**/n", "/q/n/**", "a%b", "/1/n", "é", "__n", "n__x"]
        for namespace in ("", "/q", "/q/r")
    ),
    *(
        ([text], [], [], "n", namespace)
        for namespace in ("", "/q")
        for text in (
            f"q: {{n: {{{P}: {{a: 1}}}}}}", f"/q: {{n: {{{P}: {{a: 1}}}}}}", f"/**: {{n: {{{P}: {{a: 1}}}}}}",
            f"q: {{'*': {{{P}: {{a: 1}}}}}}", f"q: {{/n: {{{P}: {{a: 1}}}}}}",
            f"q: {{n: {{{P}: {{a: 1}}}}, m: {{{P}: {{a: 2}}}}}}\nn: {{{P}: {{a: 3}}}}\n",
        )
    ),
    *(
        ([text], [], [], "n", "")
        for text in (
            "", "\n", "# c\n", "a: 1\n", "a\n", "- a\n", "[]", "{}", "n: 1\n", "n:\n  a: 1\n", "n:\n", "n: {}\n", f"n: {{{P}: }}",
            f"n:\n  {P}:\n    1\n", f"n:\n  {P}:\n    - 1\n", f"n:\n  {P}:\n    a:\n", "n: [1]\n", f"n:\n  {P}:\n    a: &x 1\n    b: *x\n",
            f"n:\n  {P}:\n   a: 1\n  b: 2\n", f'n:\n  {P}:\n    a: "x\n',
            f"n:\n  {P}:\n    a: 1\n---\nn:\n  {P}:\n    a: 2\n", "\tn: 1\n", f"{P}:\n  a: 1\n", f"n: {{{P}X: {{a: 1}}}}", f"n:\n  {P}:\n    '': 1\n",
            f"n:\n  {P}:\n    {P}:\n      a: 1\n", f"n:\n  {P}:\n    ? [a]\n    : 1\n", f"n: {{{P}: {{<<: {{a: 1}}}}}}",
            *(
                f"n: {{{P}: {body}}}\n"
                for body in (
                    "{a: 1, w: {z: 2, y: {x: [1, 2]}}, b: s}", "{a: 1, a: 2}", "{a: {}}", "{a: []}", "{a: [1, a]}", "{a: [{b: 1}]}",
                    "{a: [[1,2],[3]]}", "{a: [1,[2]]}", "{a: [[1],2]}", "{a: [{b: 1}, {c: 2}]}", "{a: [1, {b: 2}]}",
                    "{a.b: 1, c d: 2, a/b: 3, 1: 4}", "{a: null, b: ~, c: 1e3, d: 0x10, e: '1', f: yes, g: 'yes', i: !!str 5}",
                    "{qos_overrides: {/x: {publisher: {depth: 5}}}}", "{a: {b: 2}, a: {c: 1}}", "{a: 1, a: {b: 2}}", "{a: {b: 2}, a: 1}",
                    "{a: {b: {}, c: 1}}", "{a: {b.c: {d: 1}, e: 2}, z: 1}", "{a: 1, a: s, a: [1.0]}", "{a: {b: 1, b: s}}", "{a: {b: 1}, a: {b: []}}", "{d: [], c: yes, d: {c: 1}}", "{a: {b: {c: {}, d: 1}, e: 1}, f: 1}",
                )
            ),
        )
    ),
    ([f"/**: {{{P}: {{a: 1}}}}"], [], ["-p", "a:=9"], "n", ""),
    ([f"/**: {{{P}: {{a: 1}}}}"], ["-p", "a:=9"], [], "n", ""),
    ([f"/**: {{{P}: {{a: 1}}}}\nn: {{{P}: {{a: 2}}}}"], [], ["-p", "a:=9"], "n", ""),
    ([f"n: {{{P}: {{a: 2}}}}\n/**: {{{P}: {{a: 1}}}}"], [], [], "n", ""),
    ([f"n: {{{P}: {{a: 2}}}}"], [], ["-p", "a:=9"], "n", ""),
    ([f"n: {{{P}: {{a: 2}}}}"], ["-p", "a:=9"], [], "n", ""),
    ([f"n: {{{P}: {{a: 2}}}}"], [], ["-p", "n:a:=9", "-p", "a:=7"], "n", ""),
    ([f"/n: {{{P}: {{a: 1}}}}\n/**: {{{P}: {{a: 2}}}}"], [], ["-p", "n:a:=3"], "n", ""),
    ([f"n: {{{P}: {{a: 1}}}}\n/**: {{{P}: {{a: 2}}}}\n/n: {{{P}: {{a: 3}}}}"], [], [], "n", ""),
    ([f"/**: {{{P}: {{a: 1}}}}", f"/**: {{{P}: {{b: 1, a: s}}}}"], [], [], "n", ""),
    ([f"n: {{{P}: {{a: [1,2]}}}}", f"/**: {{{P}: {{a: []}}}}"], [], [], "n", ""),
    ([f"n: {{{P}: {{a: 1}}}}", f"n: {{{P}: {{a: []}}}}"], [], [], "n", ""),
    ([f"/**: {{{P}: {{a: 1}}}}"], [], ["-p", "a:=s"], "n", ""),
    ([f"n: {{{P}: {{a: 1}}}}"], [], ["-r", "__node:=n"], "m", ""),
    ([f"/s/n: {{{P}: {{a: 1}}}}"], [], ["-r", "__ns:=/s"], "n", ""),
]  # fmt: skip


def describe(arguments: list[Any], name: str = "n", namespace: str = "", **options: Any) -> str:
    """Describe a node with these process arguments."""
    context = Context()
    context.init(args=arguments)
    try:
        node = rclpy.create_node(
            name, namespace=namespace, context=context, start_parameter_services=False, **options
        )
        overrides = {key: (each.type_.name, each.value) for key, each in node._parameter_overrides.items()}
        described = (
            f"{node.get_fully_qualified_name()} {node.get_logger().name} "
            f"{[node.resolve_topic_name(topic) for topic in TOPICS]} "
            f"{[node.resolve_service_name(topic) for topic in TOPICS]} {overrides}"
        )
        node.destroy_node()
        return described
    finally:
        context.shutdown()


def with_files() -> None:
    """Parameter files with arguments before and after them."""
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        for texts, before, after, name, namespace in FILES:
            arguments = [ROS, *before]
            for number, text in enumerate(texts):
                Path(f"{number}.yaml").write_text(text)
                arguments += ["--params-file", f"{number}.yaml"]
            attempt(
                f"{texts} {before} {after} {namespace}/{name}",
                lambda arguments=arguments, after=after, name=name, namespace=namespace: describe(
                    [*arguments, *after], name, namespace
                ),
            )


def of_a_node() -> None:
    """Arguments of one node, with and without those of the process."""
    for own in (
        [], ["foo"], [ROS], [ROS, "-r", "bad"], [ROS, "--nope"], [ROS, "-r", "chatter:=l"], ["-r", "chatter:=l"],
        [ROS, "-p", "b:=2"], ["-p", "b:=2"], [ROS, "-e", "x"], [ROS, "--log-level", "nope"],
        [ROS, "-p", "b:=2", "-r", "__node:=k", "-r", "__ns:=/w"], [ROS, "-r", "n:chatter:=l"],
        [ROS, "-r", "rostopic://chatter:=ll", "-r", "chatter:=l"], [ROS, "-r", "k:chatter:=l", "-r", "__node:=k"], "abc", [1],
    ):  # fmt: skip
        for use_global in (True, False):
            attempt(
                f"{own} {use_global}",
                lambda own=own, use_global=use_global: describe(
                    [ROS, "-r", "chatter:=g", "-p", "b:=1"], cli_args=own, use_global_arguments=use_global
                ),
            )
    both = [ROS, "-r", "chatter:=g", "-r", "__node:=gn"]
    attempt("name of both", lambda: describe(both, cli_args=[ROS, "-r", "__node:=ln"]))


def removal() -> None:
    """The arguments that are left for the program."""
    for arguments in (
        ["a", ROS, "-r", "x:=y", "--", "b"], ["a", ROS, "x", "--", "b"], [ROS], [], ["a", "--", "b"], [ROS, "--"],
        ["__node:=x", "a"], ["a", ROS, "-p", "bad"], ["a", ROS, "-r"], ("a", ROS), [1], 5, "abc",
    ):  # fmt: skip
        attempt(f"remove {arguments}", lambda arguments=arguments: remove_ros_args(arguments))


def main() -> None:
    """Print all of it."""
    for rule in REMAP_RULES:
        attempt(f"-r {rule}", lambda rule=rule: describe([ROS, "-r", rule]))
    for rule in PARAMETER_NAMES:
        attempt(f"-p {rule}", lambda rule=rule: describe([ROS, "-p", rule]))
    for value in VALUES:
        attempt(f"-p a:={value!r}", lambda value=value: describe([ROS, "-p", f"a:={value}"]))
    for arguments in COMMAND_LINES:
        attempt(str(arguments), lambda arguments=arguments: describe(arguments))
    attempt("not a string", lambda: describe([1]))
    with_files()
    of_a_node()
    removal()
