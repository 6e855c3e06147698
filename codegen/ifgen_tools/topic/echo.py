"""`ifgen topic echo`."""

from __future__ import annotations

import sys
from collections.abc import Callable
from typing import Any

import click
import yaml
from ifgen.command_kit.tool import ToolError

from ifgen_tools.session import open_session
from ifgen_tools.texts.formats import as_csv, as_json, as_yaml, condition, selector
from ifgen_tools.topic import topics
from ifgen_tools.topic.options import EchoOptions


def echo(chosen: EchoOptions) -> int:
    """Print messages as they come."""
    forms = [
        form
        for form, is_chosen in (("csv", chosen.csv), ("json", chosen.as_json), ("raw", chosen.raw))
        if is_chosen
    ]
    if len(forms) > 1:
        raise click.UsageError(f"--{forms[0]} and --{forms[1]} exclude each other: leave out one")
    if len(chosen.fields) > 1:
        raise click.UsageError(
            f"--field can be given once, not {len(chosen.fields)} times: name a message with both"
        )
    if chosen.raw and (chosen.fields or chosen.filter_expression):
        raise click.UsageError("--raw shows bytes, which have no fields: leave out --field and --filter")
    wanted = condition(chosen.filter_expression)
    with open_session(chosen.transport, use_sim_time=chosen.use_sim_time) as session:
        is_named = chosen.message_type is not None
        topic = topics.find_topic(session, chosen.name, chosen.spin_time, must_exist=not is_named)
        cls = topics.class_on(session, topic, chosen.message_type)
        topics.refuse_other_types(session, topic, cls)
        select = selector(cls, chosen.fields[0]) if chosen.fields else None
        show = _printer(chosen, select, wanted)
        shown: list[bool] = []

        def hear(message: Any, info: Any) -> None:
            if not (chosen.once and shown) and show(message, info):
                shown.append(True)

        on_lost = None if chosen.no_lost_messages else _tell_of_lost
        topics.listen(
            session, topic, cls, hear, chosen.qos, raw=chosen.raw, on_lost=on_lost, is_named=is_named
        )
        session.wait_for(lambda: chosen.once and bool(shown), chosen.timeout)
    return 0


def _tell_of_lost(status: Any) -> None:
    print(
        f"A message was lost!!!\n\ttotal count change:{status.total_count_change}"
        f"\n\ttotal count: {status.total_count}---",
        flush=True,
    )


def _printer(
    chosen: EchoOptions, select: Callable[[Any], Any] | None, wanted: Callable[[Any], bool]
) -> Callable[[Any, Any], bool]:
    """A function that prints a message with its info, and returns whether it did."""

    def show(message: Any, info: Any) -> bool:
        value = message
        if select is not None:
            try:
                value = select(message)
            except IndexError:
                raise ToolError("a message has come in which the list of --field is shorter") from None
        if not wanted(value):
            return False
        sys.stdout.write(_text(value, info, chosen))
        sys.stdout.flush()
        return True

    return show


def _text(value: Any, info: Any, chosen: EchoOptions) -> str:
    with_info = chosen.include_message_info
    if chosen.as_json:
        return as_json(value, info if with_info else None) + "\n"
    if not hasattr(value, "get_fields_and_field_types"):  # bytes, or a field that is no message
        before = f"---Got new message, message info:---\n{info}\n---Message data:---\n" if with_info else ""
        return f"{before}{value}\n---\n"
    if chosen.csv:
        before = "".join(f"{part}," for part in info.values()) if with_info else ""
        return f"{before}{as_csv(value, chosen.style)}\n"
    before = f"{yaml.safe_dump(dict(info))}---\n" if with_info else ""
    return f"{before}{as_yaml(value, chosen.style)}---\n"
