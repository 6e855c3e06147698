"""Runs the stages for what has changed since an earlier run; nothing is parsed to find that out."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar

from ifgen.pipeline.freshness import notes
from ifgen.pipeline.freshness.comparison import Unchanged, unchanged_since
from ifgen.pipeline.freshness.state import state_of
from ifgen.pipeline.values import Inputs, Made
from ifgen.writing import interruption

Done = TypeVar("Done")


def unless_fresh(
    inputs: Inputs, make: Callable[[Inputs, Unchanged], Made], finish: Callable[[Inputs, Made], Done]
) -> Done:
    """Make what an earlier run did not leave as it has to be, finish that, and remember it for the next run.

    Nothing is made if nothing has changed. Once it is being finished, an interruption waits.
    """
    noted = notes.read(inputs.output)
    state = state_of(inputs, noted)
    unchanged = unchanged_since(noted, state)
    made = unchanged.done or make(inputs, unchanged)
    with interruption.held("all files had been written"):
        done = finish(inputs, made)
        if made.job is not None:
            from ifgen.pipeline.freshness.noting import note  # nothing to note if nothing has changed

            note(made.job, made.told, state, noted)
    return done
