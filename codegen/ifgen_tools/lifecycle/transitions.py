"""`ifgen lifecycle list` and `set`."""

from __future__ import annotations

import json
import sys
from collections.abc import Sequence
from typing import TYPE_CHECKING

from ifgen.command_kit.tool import ToolError

from ifgen_tools.lifecycle.remote import RemoteLifecycle, find_lifecycle_node
from ifgen_tools.session import TransportChoice, open_session

if TYPE_CHECKING:
    from lifecycle_msgs.msg import Transition, TransitionDescription


def list_transitions(
    *,
    node: str,
    transport: TransportChoice = "auto",
    spin_time: float | None = None,
    include_hidden: bool = True,
    all_: bool = False,
    as_json: bool = False,
    use_sim_time: bool = False,
) -> int:
    """Print the transitions out of a node's state, or all of them."""
    with open_session(transport, use_sim_time=use_sim_time) as session:
        remote = RemoteLifecycle(session, find_lifecycle_node(session, node, spin_time))
        found = remote.transitions(all_)
    if as_json:
        print(json.dumps([_plain(each) for each in found], indent=2))
        return 0
    for each in found:
        print(f"- {each.transition.label} [{each.transition.id}]")
        print(f"\tStart: {each.start_state.label}")
        print(f"\tGoal: {each.goal_state.label}")
    return 0


def set_state(
    *,
    node: str,
    transition: str,
    transport: TransportChoice = "auto",
    spin_time: float | None = None,
    include_hidden: bool = True,
    as_json: bool = False,
    use_sim_time: bool = False,
) -> int:
    """Go through a transition. Returns 1 if the node has failed to."""
    with open_session(transport, use_sim_time=use_sim_time) as session:
        remote = RemoteLifecycle(session, find_lifecycle_node(session, node, spin_time))
        available = [each.transition for each in remote.transitions()]
        successful = remote.change(_asked(remote.node, available, transition))
        state = remote.state() if as_json else None
    if state is not None:
        print(json.dumps({"successful": successful, "state": {"label": state.label, "id": state.id}}))
    elif successful:
        print("Transitioning successful")
    else:
        print("Transitioning failed", file=sys.stderr)
    return 0 if successful else 1


def _asked(node: str, available: Sequence[Transition], wanted: str) -> Transition:
    """The transition of a label or, if none has it, of a number."""
    for each in available:
        if each.label == wanted:
            return each
    for each in available:
        if str(each.id) == wanted:
            return each
    short = wanted if len(wanted) <= 60 else f"{wanted[:57]}..."
    known = ", ".join(f"{each.label} [{each.id}]" for each in available)
    raise ToolError(f"{node!r} has no transition '{short}' now", f"available ones are: {known or 'none'}")


def _plain(description: TransitionDescription) -> dict[str, object]:
    return {
        "label": description.transition.label,
        "id": description.transition.id,
        "start": {"label": description.start_state.label, "id": description.start_state.id},
        "goal": {"label": description.goal_state.label, "id": description.goal_state.id},
    }
