"""Creating and destroying what a node owns: publishers, subscriptions, clients, services, timers, guards."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, TypeVar

import rclpy.node  # its names are looked up there at each call: tests put others in their place
from rclpy._node.base import NodeBase
from rclpy.constants import S_TO_NS
from rclpy.exceptions import InvalidHandle, InvalidTopicNameException
from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy
from rclpy.publisher import Publisher
from rclpy.qos import QoSProfile, qos_profile_services_default
from rclpy.qos_overriding_options import _declare_qos_parameters
from rclpy.subscription import Subscription

if TYPE_CHECKING:
    from rclpy.callback_groups import CallbackGroup
    from rclpy.client import Client
    from rclpy.clock import Clock
    from rclpy.event_handler import PublisherEventCallbacks, SubscriptionEventCallbacks
    from rclpy.guard_condition import GuardCondition
    from rclpy.qos_overriding_options import QoSOverridingOptions
    from rclpy.service import Service
    from rclpy.timer import Rate, Timer


Entity = TypeVar("Entity")


class EntityFactory(NodeBase):
    """A node that creates entities and owns them until they or it are destroyed.

    Creating and destroying may happen on any thread, also while the node spins: lists change by single
    operations, and the executor is woken after each.
    """

    def _validate_topic_or_service_name(
        self, topic_or_service_name: str, *, is_service: bool = False
    ) -> None:
        """Raise the exception that says what is wrong with the name."""
        name, namespace = self.get_name(), self.get_namespace()
        rclpy.node.validate_node_name(name)
        rclpy.node.validate_namespace(namespace)
        rclpy.node.validate_topic_name(topic_or_service_name, is_service=is_service)
        expanded = rclpy.node.expand_topic_name(topic_or_service_name, name, namespace)
        rclpy.node.validate_full_topic_name(expanded, is_service=is_service)

    def _validate_qos_or_depth_parameter(self, qos_or_depth: QoSProfile | int) -> QoSProfile:
        if isinstance(qos_or_depth, QoSProfile):
            return qos_or_depth
        if not isinstance(qos_or_depth, int):
            raise TypeError(f"Expected QoSProfile or int, but received {type(qos_or_depth)!r}")
        if qos_or_depth < 0:
            raise ValueError("history depth must be greater than or equal to zero")
        return rclpy.node.QoSProfile(depth=qos_or_depth)

    def __declare_qos_overrides(
        self, kind: Any, topic: str, profile: QoSProfile, options: QoSOverridingOptions | None
    ) -> None:
        """Let parameters change the profile in place, as the options allow."""
        final_topic = self.__resolve_valid_topic(topic)
        if options is not None:
            node: Any = self
            _declare_qos_parameters(kind, node, final_topic, profile, options)

    def __resolve_valid_topic(self, topic: str) -> str:
        try:
            return self.resolve_topic_name(topic)
        except RuntimeError:
            try:
                self._validate_topic_or_service_name(topic)
            except InvalidTopicNameException as error:
                raise error from None
            raise

    def resolve_topic_name(self, topic: str, *, only_expand: bool = False) -> str:
        """Return the absolute name of a topic, remapped unless `only_expand`.

        Raises RCLError for a bad name.
        """
        with self.handle:
            return _rclpy.rclpy_resolve_name(self.handle, topic, only_expand, False)

    def resolve_service_name(self, service: str, *, only_expand: bool = False) -> str:
        """Return the absolute name of a service, remapped unless `only_expand`.

        Raises RCLError for a bad name.
        """
        with self.handle:
            return _rclpy.rclpy_resolve_name(self.handle, service, only_expand, True)

    def create_publisher(
        self,
        msg_type: Any,
        topic: str,
        qos_profile: QoSProfile | int,
        *,
        callback_group: CallbackGroup | None = None,
        event_callbacks: PublisherEventCallbacks | None = None,
        qos_overriding_options: QoSOverridingOptions | None = None,
        publisher_class: type[Publisher[Any]] = Publisher,
    ) -> Publisher[Any]:
        """Create a publisher of `msg_type` on `topic`.

        `qos_profile` may be a history depth. `callback_group` is for its QoS events. `qos_overriding_options`
        lets parameters change the profile.
        """
        profile = self._validate_qos_or_depth_parameter(qos_profile)
        self.__declare_qos_overrides(Publisher, topic, profile, qos_overriding_options)
        rclpy.node.check_is_valid_msg_type(msg_type)
        handle = self.__create_handle(_rclpy.Publisher, msg_type, topic, profile, is_service=False)
        try:
            publisher = publisher_class(
                handle,
                msg_type,
                topic,
                profile,
                event_callbacks=event_callbacks or rclpy.node.PublisherEventCallbacks(),
                callback_group=callback_group or self.default_callback_group,
            )
        except Exception:
            handle.destroy_when_not_in_use()
            raise
        self._publishers.append(publisher)
        self.__own_events_of(publisher)
        return publisher

    def create_subscription(
        self,
        msg_type: Any,
        topic: str,
        callback: Callable[..., Any],
        qos_profile: QoSProfile | int,
        *,
        callback_group: CallbackGroup | None = None,
        event_callbacks: SubscriptionEventCallbacks | None = None,
        qos_overriding_options: QoSOverridingOptions | None = None,
        raw: bool = False,
    ) -> Subscription[Any]:
        """Create a subscription to `topic`; `callback` gets the message, and its info if it takes two.

        `qos_profile` may be a history depth. With `raw` the callback gets serialized bytes.
        """
        profile = self._validate_qos_or_depth_parameter(qos_profile)
        self.__declare_qos_overrides(Subscription, topic, profile, qos_overriding_options)
        group = callback_group or self.default_callback_group
        rclpy.node.check_is_valid_msg_type(msg_type)
        handle = self.__create_handle(_rclpy.Subscription, msg_type, topic, profile, is_service=False)
        try:
            subscription = rclpy.node.Subscription(
                handle,
                msg_type,
                topic,
                callback,
                group,
                profile,
                raw,
                event_callbacks=event_callbacks or rclpy.node.SubscriptionEventCallbacks(),
            )
        except Exception:
            handle.destroy_when_not_in_use()
            raise
        group.add_entity(subscription)
        self._subscriptions.append(subscription)
        self.__own_events_of(subscription)
        return subscription

    def create_client(
        self,
        srv_type: Any,
        srv_name: str,
        *,
        qos_profile: QoSProfile = qos_profile_services_default,
        callback_group: CallbackGroup | None = None,
    ) -> Client:
        """Create a client of the service `srv_name`."""
        group = self.default_callback_group if callback_group is None else callback_group
        rclpy.node.check_is_valid_srv_type(srv_type)
        handle = self.__create_handle(_rclpy.Client, srv_type, srv_name, qos_profile, is_service=True)
        client = rclpy.node.Client(self.context, handle, srv_type, srv_name, qos_profile, group)
        return self.__own(client, self._clients, group)

    def create_service(
        self,
        srv_type: Any,
        srv_name: str,
        callback: Callable[[Any, Any], Any],
        *,
        qos_profile: QoSProfile = qos_profile_services_default,
        callback_group: CallbackGroup | None = None,
    ) -> Service:
        """Serve `srv_name`: `callback(request, response)` returns the response."""
        group = self.default_callback_group if callback_group is None else callback_group
        rclpy.node.check_is_valid_srv_type(srv_type)
        handle = self.__create_handle(_rclpy.Service, srv_type, srv_name, qos_profile, is_service=True)
        service = rclpy.node.Service(handle, srv_type, srv_name, callback, group, qos_profile)
        return self.__own(service, self._services, group)

    def create_timer(
        self,
        timer_period_sec: float,
        callback: Callable[..., Any] | None,
        callback_group: CallbackGroup | None = None,
        clock: Clock | None = None,
        autostart: bool = True,
    ) -> Timer:
        """Call `callback` every `timer_period_sec` [s] of `clock`, the node's own by default."""
        period = int(float(timer_period_sec) * S_TO_NS)
        group = self.default_callback_group if callback_group is None else callback_group
        timer = rclpy.node.Timer(
            callback,
            group,
            period,
            self._clock if clock is None else clock,
            context=self.context,
            autostart=autostart,
        )
        return self.__own(timer, self._timers, group)

    def create_guard_condition(
        self,
        callback: Callable[..., Any],
        callback_group: CallbackGroup | None = None,
    ) -> GuardCondition:
        """Call `callback` in the executor whenever the guard condition is triggered."""
        group = self.default_callback_group if callback_group is None else callback_group
        guard = rclpy.node.GuardCondition(callback, group, context=self.context)
        return self.__own(guard, self._guards, group)

    def create_rate(self, frequency: float, clock: Clock | None = None) -> Rate:
        """Create something to sleep on `frequency` [Hz] times a second; raises ValueError unless positive."""
        if frequency <= 0:
            raise ValueError("frequency must be > 0")
        timer = self.create_timer(1.0 / frequency, None, self._rate_group, clock)
        return rclpy.node.Rate(timer, context=self.context)

    def __create_handle(
        self, kind: Any, interface: Any, name: str, qos_profile: QoSProfile, *, is_service: bool
    ) -> Any:
        try:
            with self.handle:
                return kind(self.handle, interface, name, qos_profile.get_c_qos_profile())
        except ValueError:
            self._validate_topic_or_service_name(name, is_service=is_service)
            raise

    def __own(self, entity: Entity, owned: list[Entity], group: CallbackGroup) -> Entity:
        group.add_entity(entity)
        owned.append(entity)
        self._wake_executor()
        return entity

    def __own_events_of(self, endpoint: Publisher[Any] | Subscription[Any]) -> None:
        self._wake_executor()
        for handler in endpoint.event_handlers:
            self.add_waitable(handler)

    def destroy_publisher(self, publisher: Publisher[Any]) -> bool:
        """Destroy a publisher of this node; False if it is not one."""
        return self.__destroy(publisher, self._publishers)

    def destroy_subscription(self, subscription: Subscription[Any]) -> bool:
        """Destroy a subscription of this node; False if it is not one."""
        return self.__destroy(subscription, self._subscriptions)

    def destroy_client(self, client: Client) -> bool:
        """Destroy a client of this node; False if it is not one."""
        return self.__destroy(client, self._clients)

    def destroy_service(self, service: Service) -> bool:
        """Destroy a service of this node; False if it is not one."""
        return self.__destroy(service, self._services)

    def destroy_timer(self, timer: Timer) -> bool:
        """Destroy a timer of this node; False if it is not one."""
        return self.__destroy(timer, self._timers)

    def destroy_guard_condition(self, guard: GuardCondition) -> bool:
        """Destroy a guard condition of this node; False if it is not one."""
        return self.__destroy(guard, self._guards)

    def destroy_rate(self, rate: Rate) -> bool:
        """Destroy a rate of this node: whoever sleeps on it is woken by an exception."""
        destroyed = self.destroy_timer(rate._timer)
        rate.destroy()
        return destroyed

    def __destroy(self, entity: Any, owned: list[Any]) -> bool:
        try:
            owned.remove(entity)
        except ValueError:
            return False
        for handler in getattr(entity, "event_handlers", ()):
            self.remove_waitable(handler)
        try:
            entity.destroy()
        except InvalidHandle:
            return False
        self._wake_executor()
        return True

    def destroy_node(self) -> None:
        """Destroy everything the node created, and the node; a second call does nothing."""
        owned: tuple[tuple[list[Any], Callable[[Any], bool]], ...] = (
            (self._publishers, self.destroy_publisher),
            (self._subscriptions, self.destroy_subscription),
            (self._clients, self.destroy_client),
            (self._services, self.destroy_service),
            (self._timers, self.destroy_timer),
            (self._guards, self.destroy_guard_condition),
        )
        for entities, destroy in owned:
            while entities:
                for entity in list(entities):
                    destroy(entity)
        self.handle.destroy_when_not_in_use()
        self._wake_executor()
