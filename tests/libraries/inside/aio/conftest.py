"""What tests of AsyncNode share: a context, a limit in time, and meeting each other."""

from __future__ import annotations

import asyncio
import functools
import itertools
from collections.abc import Callable, Coroutine, Iterator
from typing import Any, ParamSpec

import pytest
import rclpy

P = ParamSpec("P")
_numbers = itertools.count()


def on_loop(test: Callable[P, Coroutine[Any, Any, None]]) -> Callable[P, None]:
    """Run a test on a loop of its own, for 30 s at most."""

    @functools.wraps(test)
    def run(*args: P.args, **kwargs: P.kwargs) -> None:
        async def limited() -> None:
            async with asyncio.timeout(30):
                await test(*args, **kwargs)

        asyncio.run(limited())

    return run


async def eventually(is_true: Callable[[], Any]) -> None:
    """Wait until something is true."""
    while not is_true():
        await asyncio.sleep(0.005)


async def turns(count: int = 20) -> None:
    """Give the loop a few turns, and the middleware a moment."""
    for _ in range(count):
        await asyncio.sleep(0.002)


async def met(publisher: Any, subscription: Any) -> None:
    """Wait until a publisher and a subscription have found each other."""
    await eventually(publisher.get_subscription_count)
    await eventually(subscription.get_publisher_count)


@pytest.fixture(autouse=True)
def context() -> Iterator[None]:
    """rclpy, from init to shutdown."""
    rclpy.init()
    yield
    rclpy.try_shutdown()


@pytest.fixture
def name() -> str:
    """A name that no other test uses: the middleware may still tell of those that have gone."""
    return f"name_{next(_numbers)}"
