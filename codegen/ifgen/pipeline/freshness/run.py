"""Runs the stages for what has changed since an earlier run; nothing is parsed to find that out."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import AbstractContextManager
from typing import TypeVar

from ifgen import signals
from ifgen.pipeline.freshness import notes
from ifgen.pipeline.freshness.comparison import Unchanged, unchanged_since
from ifgen.pipeline.freshness.state import state_of
from ifgen.pipeline.values import Inputs, Made

Done = TypeVar("Done")


def unless_fresh(
    inputs: Inputs,
    make: Callable[[Inputs, Unchanged], Made],
    prepare: Callable[[Inputs, Made], AbstractContextManager[Callable[[], Done]]],
) -> Done:
    """Make what an earlier run did not leave as it has to be, write that, and remember it for the next run.

    Nothing is made if nothing has changed. `prepare` does all but the last step, during which an interruption
    waits.
    """
    noted = notes.read(inputs.output)
    state = state_of(inputs, noted)
    unchanged = unchanged_since(noted, state)
    made = unchanged.done or make(inputs, unchanged)
    with prepare(inputs, made) as finish, signals.delay_interrupt("all files had been written"):
        done = finish()
        if made.job is not None:
            from ifgen.pipeline.freshness.noting import note  # nothing to note if nothing has changed

            note(made.job, made.told, state, noted, made.modules)
        return done
