"""Publishers, subscriptions, services and clients of an AsyncNode."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from typing import Any, Generic, TypeVar

from rclpy.client import Client
from rclpy.exceptions import InvalidHandle
from rclpy.publisher import Publisher
from rclpy.qos import QoSProfile
from rclpy.service import Service
from rclpy.subscription import Subscription

from rclpy_asyncio.driver import (
    MOST_AT_ONCE,
    Driver,
    Port,
    follow,
    take_message,
    take_request,
    take_response,
)

EntityT = TypeVar("EntityT", bound="Publisher[Any] | Subscription[Any] | Service[Any] | Client[Any]")


class AsyncEntity(Generic[EntityT]):
    """An entity of rclpy that a driver runs.

    :param destroy: lets the node of rclpy destroy the entity.
    :param on_destroy: lets the AsyncNode forget this.
    """

    def __init__(
        self,
        driver: Driver,
        entity: EntityT,
        destroy: Callable[[EntityT], object],
        on_destroy: Callable[[AsyncEntity[Any]], object],
    ) -> None:
        self._driver = driver
        self._entity = entity
        self._destroy = destroy
        self._on_destroy = on_destroy
        self._is_destroyed = False

    @property
    def handle(self) -> Any:
        """The client library's side."""
        return self._entity.handle

    @property
    def qos_profile(self) -> QoSProfile:
        """The profile that it was made with."""
        profile: QoSProfile = self._entity.qos_profile
        return profile

    def destroy(self) -> None:
        """Destroy it, and cancel its callbacks that run."""
        if not self._is_destroyed:
            self._is_destroyed = True
            self._driver.forget(self._entity)
            self._on_destroy(self)
            self._destroy(self._entity)

    def _serve_by(self, take: Any, run: Any, *, concurrent: bool | int = False) -> None:
        limit = MOST_AT_ONCE if concurrent is True else max(int(concurrent), 1)
        self._driver.serve(self._entity, Port(self._driver, self._entity, take, run, limit=limit).serve)


class AsyncPublisher(AsyncEntity["Publisher[Any]"]):
    """Publishes on a topic; made by `AsyncNode.create_publisher`."""

    @property
    def topic_name(self) -> str:
        """The full topic name: expanded and remapped."""
        return self._entity.topic_name

    def publish(self, msg: Any) -> None:
        """Publish a message or its bytes, also while the node does not run; any thread.

        :raises InvalidHandle: once it is destroyed.
        """
        if self._is_destroyed:
            raise InvalidHandle("Cannot publish on a destroyed publisher")
        self._entity.publish(msg)

    def get_subscription_count(self) -> int:
        """Return the number of matched subscriptions."""
        return self._entity.get_subscription_count()


class AsyncSubscription(AsyncEntity["Subscription[Any]"]):
    """Receives the messages of a topic; made by `AsyncNode.create_subscription`."""

    def start(self, *, concurrent: bool | int) -> AsyncSubscription:
        """Take messages as soon as the node runs."""
        self._serve_by(*take_message(self._driver, self._entity), concurrent=concurrent)
        return self

    @property
    def topic_name(self) -> str:
        """The full topic name: expanded and remapped."""
        return self._entity.topic_name

    def get_publisher_count(self) -> int:
        """Return the number of matched publishers."""
        return self._entity.get_publisher_count()


class AsyncService(AsyncEntity["Service[Any]"]):
    """Responds to requests; made by `AsyncNode.create_service`."""

    def start(self, *, concurrent: bool | int) -> AsyncService:
        """Take requests as soon as the node runs."""
        self._serve_by(*take_request(self._driver, self._entity), concurrent=concurrent)
        return self

    @property
    def service_name(self) -> str:
        """The full service name: expanded and remapped."""
        return self._entity.service_name


class AsyncClient(AsyncEntity["Client[Any]"]):
    """Calls a service; made by `AsyncNode.create_client`."""

    def start(self) -> AsyncClient:
        """Take responses as soon as the node runs."""
        self._calls: set[asyncio.Future[Any]] = set()
        self._serve_by(*take_response(self._driver, self._entity))
        return self

    @property
    def service_name(self) -> str:
        """The full service name: expanded and remapped."""
        return self._entity.service_name

    def service_is_ready(self) -> bool:
        """Return whether a server is there."""
        return self._entity.service_is_ready()

    async def wait_for_service(self, *, check_interval: float = 0.1) -> None:
        """Wait until a server is there.

        :param check_interval: how often to look [s], where rclpy announces no change of the graph.
        :raises RuntimeError: if the node does not run.
        """
        self._driver.must_run(f"wait for the service {self.service_name}")
        await self._driver.sources.until(self.service_is_ready, check_interval)

    async def call(self, request: Any) -> Any:
        """Send a request, and return the response. Calls may overlap.

        Give it up with `asyncio.timeout` or by cancelling the task: a late response is dropped. A client
        that is destroyed meanwhile raises CancelledError here.

        :raises RuntimeError: if the client is destroyed, or the node does not run.
        :raises ServerGoneError: if the server leaves; only on the local transport, where that is known.
        """
        if self._is_destroyed:
            raise RuntimeError("Calling a destroyed client is forbidden")
        self._driver.must_run(f"call of {self.service_name}")
        future = self._entity.call_async(request)
        waiting = follow(future)
        self._calls.add(waiting)
        try:
            return await waiting
        finally:
            self._calls.discard(waiting)
            self._entity.remove_pending_request(future)

    def destroy(self) -> None:
        """Destroy it; calls that wait raise CancelledError."""
        super().destroy()
        for call in list(self._calls):
            call.cancel()
