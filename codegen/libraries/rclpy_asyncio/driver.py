"""Runs the entities of one node as coroutines of the user's event loop, where an executor would run them."""

from __future__ import annotations

import asyncio
import functools
import inspect
import threading
from collections.abc import Callable, Coroutine, Generator
from types import TracebackType
from typing import Any, TypeVar

from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.client import Client
from rclpy.exceptions import InvalidHandle
from rclpy.guard_condition import GuardCondition
from rclpy.node import Node
from rclpy.service import Service
from rclpy.subscription import Subscription
from rclpy.task import Future
from rclpy.timer import Timer

from rclpy_asyncio.readiness import Bell, RCLError, Sources, make_sources, ring_later

T = TypeVar("T")
Unfinished = Coroutine[Any, Any, Any] | None
Working = tuple[Callable[[], Any], Callable[[Any], Unfinished]]  # what a Port takes by, and what it runs

MOST_AT_ONCE = 100
"""How many callbacks of one entity run at a time with `concurrent=True`; more wait in its history."""

_BURST = 16  # callbacks that never await may run one after the other before the loop gets its turn


class Port:
    """Takes what comes to one entity and runs its callback, up to `limit` at a time.

    :param take: returns the next item, None if there is none.
    :param run: begins to work on an item, and returns the coroutine that remains, if one does.
    :param lock: is held from taking to the end of the callback.
    """

    def __init__(
        self,
        driver: Driver,
        entity: Any,
        take: Callable[[], Any],
        run: Callable[[Any], Unfinished],
        *,
        limit: int = 1,
        lock: asyncio.Lock | None = None,
    ) -> None:
        self._driver = driver
        self._entity = entity
        self._take = take
        self._run = run
        self._limit = limit
        self._lock = lock
        self._tasks: set[asyncio.Task[Any]] = set()

    async def serve(self) -> None:
        """Serve the entity until the task is cancelled, or its handle is gone."""
        bell = Bell(self._driver.loop)
        sources = self._driver.sources
        sources.attach(self._entity, bell)
        in_a_row = 0
        try:
            while True:
                bell.clear()
                if len(self._tasks) < self._limit:
                    if self._lock is not None:
                        await self._lock.acquire()
                    try:
                        item = self._take()
                        if item is not None:
                            in_a_row += 1
                            await self._work(item, bell, in_a_row)
                            continue
                    finally:
                        if self._lock is not None:
                            self._lock.release()
                    sources.arm(self._entity)
                in_a_row = 0
                await bell.wait()
        except (InvalidHandle, RCLError):
            if not self._is_destroyed():
                raise  # of something that the callback has used
        finally:
            sources.detach(self._entity)
            for task in self._tasks:
                task.cancel()

    def _is_destroyed(self) -> bool:
        try:
            with getattr(self._entity, "handle", self._entity):
                return False
        except InvalidHandle:
            return True

    async def _work(self, item: Any, bell: Bell, in_a_row: int) -> None:
        remaining = self._run(item)
        if remaining is not None and self._limit == 1:
            await remaining
        elif remaining is not None:
            task = self._driver.spawn(remaining)
            self._tasks.add(task)

            def forget(task: asyncio.Task[Any]) -> None:
                self._tasks.discard(task)
                bell.ring()

            task.add_done_callback(forget)
        if in_a_row % _BURST == 0:
            await asyncio.sleep(0)


class Driver:
    """Runs the entities of a node; the node takes it for its executor.

    Entities that have a coroutine function of their own (`serve`) run by it, in the order in which they were
    made. The others (services of parameters, the subscription of /clock, QoS events) run as usual.

    :param serve_timer: runs a timer that has a callback of rclpy.
    :param bridges: whether callbacks that run as usual may await futures of rclpy.
    """

    def __init__(
        self,
        node: Node,
        serve_timer: Callable[[Driver, Timer], Coroutine[Any, Any, None]],
        *,
        bridges: bool = False,
    ) -> None:
        self.node = node
        self._bridges = bridges
        self.loop: asyncio.AbstractEventLoop
        self.sources: Sources
        self.is_running = False
        self._serve_timer = serve_timer
        self._group: asyncio.TaskGroup
        self._thread = 0
        self._serving: dict[Any, Callable[[], Coroutine[Any, Any, None]]] = {}
        self._tasks: dict[Any, asyncio.Task[None]] = {}
        self._others: set[asyncio.Task[Any]] = set()  # of callbacks
        self.goals: set[asyncio.Task[Any]] = set()
        self._locks: dict[Any, asyncio.Lock] = {}
        self._is_scanned = False
        self._ended: asyncio.Future[None]
        me: Any = self  # has what a node asks of its executor, and nothing that spins
        node.executor = me

    # What a node and its actions ask of an executor

    def add_node(self, node: Node) -> bool:
        """Accept the node that it was made for."""
        return node is self.node

    def remove_node(self, node: Node) -> None:
        """Let the node go to an executor: not while it runs here."""
        if self.is_running:
            raise RuntimeError(f"the node {node.get_name()} runs on an event loop: no executor can have it")

    def wake(self) -> None:
        """Look for entities that have come or gone, at the next turn of the loop."""
        if not self.is_running or not self._is_scanned:
            return
        self._is_scanned = False
        if threading.get_ident() == self._thread:
            self.loop.call_soon(self._scan)
        else:
            ring_later(self.loop, self._scan)

    def create_task(
        self, callback: Callable[..., Any] | Coroutine[Any, Any, Any], *args: Any
    ) -> asyncio.Task[Any]:
        """Run a coroutine, or a function with arguments: action servers let their goals run so.

        These end by themselves, also after `stop`, so that clients hear of the end.
        """
        given: Any = callback
        coroutine = given if inspect.iscoroutine(given) else _call(given, args)
        task = self.loop.create_task(_bridged(coroutine) if self._bridges else coroutine)
        self.goals.add(task)
        task.add_done_callback(self.goals.discard)
        return task

    def spawn(self, coroutine: Coroutine[Any, Any, T]) -> asyncio.Task[T]:
        """Run a coroutine as a task of the node, which `stop` cancels."""
        task = self._group.create_task(coroutine)
        self._others.add(task)
        task.add_done_callback(self._others.discard)
        return task

    def fail(self, error: Exception) -> None:
        """End the node with an exception."""
        try:
            self.spawn(_raise(error))
        except RuntimeError:  # it ends already
            self.node.get_logger().error(f"a callback has failed while the node ended: {error!r}")

    # Its life

    async def start(self) -> None:
        """Run the entities from now on, as tasks of a group."""
        self.loop = asyncio.get_running_loop()
        self._thread = threading.get_ident()
        self._group = asyncio.TaskGroup()
        await self._group.__aenter__()
        self._ended = self.loop.create_future()
        self.sources = make_sources(self.node, self.loop, self.on_shutdown, self.fail)
        self.is_running = True
        self._scan()

    async def ended(self) -> None:
        """Wait until `stop` is called."""
        await asyncio.shield(self._ended)

    def on_shutdown(self) -> None:
        """Do what the end of the context asks for, in the loop; the node sets this."""
        self.stop()

    def stop(self) -> None:
        """Cancel all tasks but those of goals; any thread."""
        if not self.in_loop():
            ring_later(self.loop, self.stop)
        if not self.in_loop() or not self.is_running:
            return
        self.is_running = False
        for task in (*self._tasks.values(), *self._others):
            task.cancel()
        self._tasks.clear()
        self.sources.close()
        if not self._ended.done():
            self._ended.set_result(None)

    async def finish(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        """Wait for all tasks; raises their exceptions and that of the body in an ExceptionGroup.

        A CancelledError of the body goes on as it is.
        """
        try:
            await self._group.__aexit__(kind, error, traceback)
        finally:
            if self.goals:
                await asyncio.wait(self.goals)

    def in_loop(self) -> bool:
        """Whether this is the loop's thread, or nothing runs yet."""
        return not self.is_running or threading.get_ident() == self._thread

    def must_run(self, what: str) -> None:
        """Raise RuntimeError for a wait that nothing would end."""
        if not self.is_running:
            raise RuntimeError(
                f"{what} on the node {self.node.get_name()}, which does not run: "
                "write `async with node:` around it, or let another task `await node.run()`"
            )

    # Its entities

    def serve(self, entity: Any, serve: Callable[[], Coroutine[Any, Any, None]]) -> None:
        """Run an entity of the node by this coroutine function."""
        self._serving[entity] = serve
        self.wake()

    def forget(self, entity: Any) -> None:
        """Run it no more, and cancel its callback if one runs."""
        self._serving.pop(entity, None)
        if (task := self._tasks.pop(entity, None)) is not None:
            task.cancel()
        if self.is_running:
            self.sources.detach(entity)

    def _scan(self) -> None:
        self._is_scanned = True
        if not self.is_running:
            return
        node = self.node
        present = dict.fromkeys(self._serving)
        for kind in (
            node.timers,
            node.subscriptions,
            node.clients,
            node.services,
            node.guards,
            node.waitables,
        ):
            present.update(dict.fromkeys(kind))
        for entity in [each for each in self._tasks if each not in present]:
            self.forget(entity)
        for entity in present:
            if entity not in self._tasks:
                serve = self._serving.get(entity)
                serving = self._serve_as_usual(entity) if serve is None else serve()
                self._tasks[entity] = self._group.create_task(serving)

    async def _serve_as_usual(self, entity: Any) -> None:
        """Run an entity as an executor does: its callback group decides what runs beside it."""
        group = entity.callback_group
        if isinstance(entity, Timer):
            await self._serve_timer(self, entity)
            return
        exclusive = isinstance(group, MutuallyExclusiveCallbackGroup)
        lock = self._locks.setdefault(group, asyncio.Lock()) if exclusive else None
        limit = 1 if exclusive else MOST_AT_ONCE
        make: Any = take_waitable
        for kind, ports in _PORTS.items():
            if isinstance(entity, kind):
                make = ports
        take, run = make(self, entity)

        def bridged(item: Any) -> Unfinished:
            later = run(item)
            return None if later is None else _bridged(later)

        port = Port(self, entity, take, bridged if self._bridges else run, limit=limit, lock=lock)
        await port.serve()


async def _call(callback: Callable[..., Any], args: tuple[Any, ...]) -> Any:
    result = callback(*args)
    return await result if inspect.isawaitable(result) else result


async def _raise(error: Exception) -> None:
    raise error


def remaining(result: Any) -> Unfinished:
    """Return what a callback has left to do: a coroutine, or None."""
    if result is not None and inspect.isawaitable(result):
        return result if inspect.iscoroutine(result) else _await(result)
    return None


async def _await(awaitable: Any) -> Any:
    return await awaitable


def takes(function: Callable[..., Any], count: int) -> bool:
    """Whether a function can be called with this many positional arguments."""
    try:
        inspect.signature(function).bind(*[None] * count)
    except TypeError:
        return False
    return True


async def wrap_future(future: Future[T], *, give_up: bool = True) -> T:
    """Await a future of rclpy, which a coroutine of asyncio cannot do by itself.

    :param give_up: whether cancelling this cancels the future, too.
    """
    try:
        return await follow(future)
    except asyncio.CancelledError:
        if give_up:
            future.cancel()
        raise


def follow(future: Future[T]) -> asyncio.Future[T]:
    """Return a future of asyncio that ends as this one of rclpy does, whoever completes that."""
    follower: asyncio.Future[T] = asyncio.get_running_loop().create_future()

    loop, thread = follower.get_loop(), threading.get_ident()

    def settle(future: Future[T]) -> None:
        if threading.get_ident() != thread:
            ring_later(loop, functools.partial(settle, future))
            return
        if follower.done():  # who waited was cancelled in this turn of the loop
            return
        error = future.exception()
        if error is not None:
            follower.set_exception(error)
        else:
            follower.set_result(future.result())

    future.add_done_callback(settle)
    return follower


async def _bridged(coroutine: Coroutine[Any, Any, Any]) -> Any:
    """Run a coroutine that awaits futures of rclpy besides those of asyncio."""
    return await _Bridge(coroutine)


class _Bridge:
    """Steps a coroutine, and waits for the futures of rclpy that it yields."""

    def __init__(self, coroutine: Coroutine[Any, Any, Any]) -> None:
        self._coroutine = coroutine

    def __await__(self) -> Generator[Any, Any, Any]:
        error: BaseException | None = None
        while True:
            try:
                awaited = self._coroutine.send(None) if error is None else self._coroutine.throw(error)
            except StopIteration as end:
                return end.value
            error = None
            try:
                if _is_of_rclpy(awaited):
                    follower = follow(awaited)
                    # The coroutine itself asks for the result.
                    yield from asyncio.wait((follower,)).__await__()
                    if not follower.cancelled():
                        follower.exception()
                else:
                    yield awaited
            except BaseException as raised:
                error = raised


def _is_of_rclpy(awaited: object) -> bool:
    return isinstance(awaited, Future)


# How to take from each kind, and what to do with what was taken


def take_message(driver: Driver, entity: Subscription[Any]) -> Working:
    """Return how to take a message of a subscription, and how to call back with it."""
    handle: Any = entity.handle
    callback = entity.callback
    take_at_once = getattr(handle, "take", None)  # ours can take a message without its metadata
    wants_info = not takes(callback, 1)

    def take() -> Any:
        if wants_info or take_at_once is None:
            return handle.take_message(entity.msg_type, entity.raw)
        return take_at_once(entity.raw)

    def run(taken: Any) -> Unfinished:
        return remaining(callback(*taken) if wants_info else callback(taken[0]))

    return take, run


def take_request(driver: Driver, entity: Service[Any]) -> Working:
    """Return how to take a request of a service, and how to respond to it."""
    handle: Any = entity.handle
    fail = getattr(handle, "fail", None)  # ours tells the client

    def take() -> Any:
        request, header = handle.service_take_request(entity.srv_type.Request)
        return None if header is None else (request, header)

    def run(taken: Any) -> Unfinished:
        request, header = taken
        try:
            result = entity.callback(request, entity.srv_type.Response())
            later = remaining(result)
            if later is None:
                entity.send_response(result, header)
        except BaseException as error:
            refuse(header, error)
            raise
        return None if later is None else respond(later, header)

    async def respond(later: Coroutine[Any, Any, Any], header: Any) -> None:
        try:
            entity.send_response(await later, header)
        except BaseException as error:
            refuse(header, error)
            raise

    def refuse(header: Any, error: BaseException) -> None:
        if fail is not None and handle.pointer:
            fail(header.request_id, f"its callback has failed ({type(error).__name__})")

    return take, run


def take_response(driver: Driver, entity: Client[Any]) -> Working:
    """Return how to take a response for a client, and how to complete its future."""
    handle: Any = entity.handle
    take_failure = getattr(handle, "take_failure", None)  # ours says that a server has gone

    def take() -> Any:
        header, response = handle.take_response(entity.srv_type.Response)
        if header is None and take_failure is not None:
            header, response = take_failure()
        return None if header is None else (header, response)

    def run(taken: Any) -> Unfinished:
        header, response = taken
        try:
            future: Any = entity.get_pending_request(header.request_id.sequence_number)
        except KeyError:  # given up
            return None
        if isinstance(response, Exception):
            future._fail(response)
        else:
            future.set_result(response)
        return None

    return take, run


def take_waitable(driver: Driver, entity: Any) -> Working:
    """Return how to take the data of a waitable, in a tuple because None is data, and how to execute it."""

    def take() -> Any:
        return (entity.take_data(),) if driver.sources.is_ready(entity) else None

    def run(taken: Any) -> Unfinished:
        begun: Unfinished = entity.execute(taken[0])
        return begun

    return take, run


def _take_trigger(driver: Driver, entity: GuardCondition) -> Working:
    """Return how to take the trigger of a guard condition, and how to call back."""

    def take() -> Any:
        return driver.sources.is_ready(entity) or None

    def run(taken: Any) -> Unfinished:
        return remaining(entity.callback() if entity.callback is not None else None)

    return take, run


_PORTS: dict[type, Any] = {
    Subscription: take_message,
    Service: take_request,
    Client: take_response,
    GuardCondition: _take_trigger,
}
