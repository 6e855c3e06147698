"""Where we differ from ros2 on purpose, and what cannot be the same in two runs.

Each entry says which command lines it is about, why, and what it makes of an output before the two are compared.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TypeAlias

from tests.tools.transcript import Run

Change: TypeAlias = Callable[[Run], Run]


@dataclass(frozen=True)
class Difference:
    """What is not compared on the command lines that a pattern matches, and why."""

    commands: str
    why: str
    change: Change


def out(pattern: str, replacement: str) -> Change:
    """Replace what a pattern matches in the standard output."""
    return lambda run: replace(run, out=re.sub(pattern, replacement, run.out, flags=re.MULTILINE))


def sorted_lines(run: Run) -> Run:
    """The lines of the standard output in order."""
    return replace(run, out="".join(sorted(run.out.splitlines(keepends=True))))


def first_measurement(run: Run) -> Run:
    """The first result of a program that measures, without its numbers; what it says before is left out."""
    lines = [
        re.sub(r"[\d.e-]+", "N", line) for line in run.out.splitlines() if not line.startswith("WARNING")
    ]
    start = next(
        (n for n, line in enumerate(lines) if "N" in line and not line.startswith("Sub")), len(lines)
    )
    return replace(run, out="\n".join(lines[:start][:1] + lines[start : start + 2]))


def events(run: Run) -> Run:
    """The kinds of service events that were seen, each once, without times, clients and numbers."""
    hidden = re.sub(
        r"^( *(?:sec|nanosec|sequence_number): )\d+|^ *- \d+\n", r"\1", run.out, flags=re.MULTILINE
    )
    return replace(run, out="---\n".join(sorted(set(hidden.split("---\n")))))


def whether_it_complains(run: Run) -> Run:
    """`complaint` instead of an error message."""
    return replace(run, err="complaint\n" if run.err else "")


IN_ANY_RUN = (
    Difference(
        "topic info -v",
        "an endpoint has another GID in each run",
        out(r"^GID: .*", "GID"),
    ),
    Difference(
        "action send_goal",
        "a goal has another ID in each run",
        out(r"(?<=with ID: )[0-9a-f]{32}", "ID"),
    ),
    Difference(
        "service call",
        "whether the service is known at once depends on how busy the machine is",
        out("^waiting for service to become available...\n", ""),
    ),
    Difference(
        "topic pub -t",
        "whether the subscription is known at once depends on how busy the machine is",
        out(r"^(Waiting for at least 1 matching.*\n)+", ""),
    ),
    Difference(
        "service call -r",
        "how often a service is called until Ctrl-C is not the same twice",
        lambda run: replace(run, out="\n\n".join(run.out.split("\n\n")[:2])),
    ),
    Difference(
        "action send_goal -f",
        "feedback may come before the word that the goal was accepted",
        lambda run: replace(run, out="\n\n".join(sorted(run.out.split("\n\n")))),
    ),
    Difference(
        "action send_goal .*30", "how far it came until Ctrl-C is not the same twice", out(r"^- \d+\n", "")
    ),
    Difference("service echo", "times, clients and numbers of calls differ", events),
    Difference(
        "topic pub -w",
        "how often a second is over until a timeout of a second differs",
        out(r"^(Waiting for .*\n)\1*", r"\1"),
    ),
    Difference("topic (hz|bw|delay)", "measured numbers differ", first_measurement),
    Difference(
        "interface package|lifecycle nodes",
        "ros2 prints a set of Python, in any order; we print them in order",
        sorted_lines,
    ),
)

ON_PURPOSE = (
    Difference(
        "",
        "our errors say what to do about it, in the form of all errors of ifgen; both are on stderr",
        whether_it_complains,
    ),
    Difference(
        "param (set|delete|load)|lifecycle set",
        "whatever was refused is a failure: ros2 says so, and exits with 0",
        lambda run: replace(run, code=int(bool(run.err))),
    ),
    Difference(
        "action send_goal",
        "a goal that the server rejects is a failure: ros2 says so, and exits with 0",
        lambda run: replace(run, code=1) if "Goal was rejected" in run.out else run,
    ),
    Difference(
        "param set .*names ",
        "ros2 takes a list of several types for a text, which the node refuses; nodes read no such list",
        lambda run: replace(run, err="complaint\n", code=1) if "[a, 1]" in run.words else run,
    ),
    Difference(
        "param describe",
        "ros2 does not tell that there is no such parameter",
        lambda run: replace(run, code=1, err="complaint\n") if not run.out else run,
    ),
    Difference(
        "param list$",
        "ros2 sorts by the names of nodes without their namespaces, we sort by the full names",
        lambda run: replace(run, out="".join(sorted(re.split(r"^(?=/)", run.out, flags=re.MULTILINE)))),
    ),
    Difference(
        "(topic|service|action) type|topic echo",
        "ros2 exits without a word if there is no such name, or with a warning on stdout",
        lambda run: replace(run, err="", out="") if run.code == 1 else run,
    ),
    Difference(
        "topic (hz|bw|delay)|service echo|action send_goal .*30",
        "after Ctrl-C, ros2 fails to shut down a second time, or forgets that it was interrupted",
        lambda run: replace(run, err="", code=2) if run.interrupted else run,
    ),
    Difference("topic echo .*--csv", "ros2 does not quote texts with commas", out('"', "")),
    Difference(
        "topic echo .*--csv",
        "ros2 drops the commas after empty fields at the start of a line, which shifts the columns",
        out("^,+", ""),
    ),
    Difference(
        "topic echo .*--raw",
        "DDS pads a message to four bytes, the local transport does not",
        out(r'(\\x00)+"$', '"'),
    ),
    Difference(
        "service echo /plant",
        "the ros2 that was recorded prints the number of an event's kind, that of Jazzy's documentation the name",
        out(r"(?<=event_type: )\w+", "KIND"),
    ),
    Difference(
        "action send_goal .*Nothing",
        "we wait for the server, which may describe a type that is not installed",
        out("^Waiting for an action server.*\n", ""),
    ),
    Difference(
        "action info",
        "ros2 shows an action that is not there as one without clients and servers",
        lambda run: replace(run, out="", err="", code=1) if "servers: 0" in run.out or run.code else run,
    ),
    Difference(
        "service list --include-hidden",
        "ros2 lists the services of its own node, ours has none",
        out(r"^/_ros2cli_.*\n", ""),
    ),
    Difference("interface show .*--no-comments", "ros2 leaves the sign of a comment", out(" *#$", "")),
    Difference(
        "param dump",
        "ros2 writes bytes as binary data, which nodes cannot read; we write them as a comment",
        out(r"    raw:\n(    - !!binary \|\n *\S+\n)+|    #.*\n", ""),
    ),
    Difference(
        "topic list -v",
        "ros2 counts the publishers of its own node, ours has none",
        out(r"^( \* /(rosout|parameter_events) .*\]) .*", r"\1"),
    ),
    Difference(
        "topic info -v",
        "DDS does not tell the history and depth of others; the local transport does",
        out(r"^(  History \(Depth\)): .*", r"\1"),
    ),
)


def compared(run: Run) -> Run:
    """A run without what is not compared."""
    for difference in (*IN_ANY_RUN, *ON_PURPOSE):
        if re.match(difference.commands, run.words):
            run = difference.change(run)
    return run
