"""The rates on the page are those per simulated second, over a few of these."""

from __future__ import annotations

import pytest

pytest.importorskip("mujoco")
from humanoid.show.web.heard import Rates


def test_rates_count_simulated_seconds() -> None:
    rates = Rates()
    assert (rates.factor, rates.per_second()) == (None, {})
    for moment in range(20):  # at half of real time; one message twice a simulated second, one stopped at 2 s
        counts = {"a": moment, "b": min(moment, 4)} | ({"late": moment} if moment > 15 else {})
        rates.count(float(moment), moment / 2, counts)
    assert rates.factor == 0.5
    assert rates.per_second() == {"a": 2.0, "b": 0.0}
    rates.count(20.0, 9.5, {"a": 19, "b": 4})  # paused
    assert rates.factor == 0.0
    rates.count(21.0, 0.0, {"a": 19, "b": 4})  # started again
    assert rates.per_second() == {}
