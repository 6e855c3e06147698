"""`ifgen topic echo`."""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import click
import yaml

from ifgen_tools.errors import ToolError
from ifgen_tools.expressions import condition
from ifgen_tools.qos import chosen_qos
from ifgen_tools.session import open_session
from ifgen_tools.texts.csv_text import as_csv
from ifgen_tools.texts.json_text import as_json
from ifgen_tools.texts.selecting import selector
from ifgen_tools.texts.yaml_text import Style, as_yaml
from ifgen_tools.topic import listening


@dataclass(frozen=True, slots=True)
class Showing:
    """The parts of each message that are shown, and how: `form` is yaml, csv, json or raw."""

    form: str
    style: Style
    with_info: bool


def echo(
    *,
    topic_name: str,
    message_type: str | None,
    transport: Any,
    spin_time: float | None,
    use_sim_time: bool,
    field: str | None,
    filter_expression: str | None,
    once: bool,
    timeout: float | None,
    no_lost_messages: bool,
    form: str,
    style: Style,
    include_message_info: bool,
    **options: Any,
) -> int:
    """Print messages as they come."""
    if form == "raw" and (field or filter_expression):
        raise click.UsageError("--raw shows bytes, which have no fields: leave out --field and --filter")
    wanted = condition(filter_expression)
    chosen = chosen_qos(options)
    with open_session(transport, use_sim_time=use_sim_time) as session:
        topic = listening.find_topic(session, topic_name, spin_time, must_exist=message_type is None)
        cls = listening.class_on(session, topic, message_type)
        listening.refuse_other_types(session, topic, cls)
        select = selector(cls, field) if field is not None else None
        show = _printer(Showing(form, style, include_message_info), select, wanted)
        shown: list[bool] = []

        def hear(message: Any, info: Any) -> None:
            if not (once and shown) and show(message, info):
                shown.append(True)

        on_lost = None if no_lost_messages else _tell_of_lost
        listening.listen(
            session,
            topic,
            cls,
            hear,
            chosen,
            raw=form == "raw",
            on_lost=on_lost,
            is_named=message_type is not None,
        )
        session.wait_for(lambda: once and bool(shown), timeout)
    return 0


def _tell_of_lost(status: Any) -> None:
    print(
        f"A message was lost!!!\n\ttotal count change:{status.total_count_change}"
        f"\n\ttotal count: {status.total_count}---",
        flush=True,
    )


def _printer(
    showing: Showing, select: Callable[[Any], Any] | None, wanted: Callable[[Any], bool]
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
        sys.stdout.write(_text(value, info, showing))
        sys.stdout.flush()
        return True

    return show


def _text(value: Any, info: Any, showing: Showing) -> str:
    with_info = showing.with_info
    if showing.form == "json":
        return as_json(value, info if with_info else None) + "\n"
    if not hasattr(value, "get_fields_and_field_types"):  # bytes, or a field that is no message
        before = f"---Got new message, message info:---\n{info}\n---Message data:---\n" if with_info else ""
        return f"{before}{value}\n---\n"
    if showing.form == "csv":
        before = "".join(f"{part}," for part in info.values()) if with_info else ""
        return f"{before}{as_csv(value, showing.style)}\n"
    before = f"{yaml.safe_dump(dict(info))}---\n" if with_info else ""
    return f"{before}{as_yaml(value, showing.style)}---\n"
