"""What a node sees of the others: names, types, counts, endpoints."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import rclpy.node  # its names are looked up there at each call: tests put others in their place
from rclpy._node.base import NodeBase
from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy
from rclpy.impl.waiting import wait_for_graph

if TYPE_CHECKING:
    from rclpy.topic_endpoint_info import TopicEndpointInfo

NamesAndTypes = list[tuple[str, list[str]]]


class GraphQueries(NodeBase):
    """A node that can ask about its domain.

    Queries by node raise NodeNameNonExistentError for a node that does not exist.
    """

    def get_publisher_names_and_types_by_node(
        self, node_name: str, node_namespace: str, no_demangle: bool = False
    ) -> NamesAndTypes:
        """Return (topic, types) of everything a node publishes."""
        with self.handle:
            return _rclpy.rclpy_get_publisher_names_and_types_by_node(
                self.handle, no_demangle, node_name, node_namespace
            )

    def get_subscriber_names_and_types_by_node(
        self, node_name: str, node_namespace: str, no_demangle: bool = False
    ) -> NamesAndTypes:
        """Return (topic, types) of everything a node subscribes to."""
        with self.handle:
            return _rclpy.rclpy_get_subscriber_names_and_types_by_node(
                self.handle, no_demangle, node_name, node_namespace
            )

    def get_service_names_and_types_by_node(self, node_name: str, node_namespace: str) -> NamesAndTypes:
        """Return (service, types) of everything a node serves."""
        with self.handle:
            return _rclpy.rclpy_get_service_names_and_types_by_node(self.handle, node_name, node_namespace)

    def get_client_names_and_types_by_node(self, node_name: str, node_namespace: str) -> NamesAndTypes:
        """Return (service, types) of everything a node is a client of."""
        with self.handle:
            return _rclpy.rclpy_get_client_names_and_types_by_node(self.handle, node_name, node_namespace)

    def get_topic_names_and_types(self, no_demangle: bool = False) -> NamesAndTypes:
        """Return (topic, types) of every topic."""
        with self.handle:
            return _rclpy.rclpy_get_topic_names_and_types(self.handle, no_demangle)

    def get_service_names_and_types(self) -> NamesAndTypes:
        """Return (service, types) of every service."""
        with self.handle:
            return _rclpy.rclpy_get_service_names_and_types(self.handle)

    def get_node_names(self) -> list[str]:
        """Return the name of every node, without namespaces."""
        return [name for name, _ in self.get_node_names_and_namespaces()]

    def get_fully_qualified_node_names(self) -> list[str]:
        """Return the full name of every node."""
        return [
            namespace + name if namespace.endswith("/") else f"{namespace}/{name}"
            for name, namespace in self.get_node_names_and_namespaces()
        ]

    def get_node_names_and_namespaces(self) -> list[tuple[str, str]]:
        """Return (name, namespace) of every node."""
        with self.handle:
            names: list[tuple[str, str]] = self.handle.get_node_names_and_namespaces()
            return names

    def get_node_names_and_namespaces_with_enclaves(self) -> list[tuple[str, str, str]]:
        """Return (name, namespace, enclave) of every node."""
        with self.handle:
            names: list[tuple[str, str, str]] = self.handle.get_node_names_and_namespaces_with_enclaves()
            return names

    def count_publishers(self, topic_name: str) -> int:
        """Count the publishers of a topic, which is expanded but not remapped.

        Raises ValueError for a bad name.
        """
        with self.handle:
            return self.__count(topic_name, self.handle.get_count_publishers)

    def count_subscribers(self, topic_name: str) -> int:
        """Count the subscriptions of a topic, which is expanded but not remapped.

        Raises ValueError for a bad name.
        """
        with self.handle:
            return self.__count(topic_name, self.handle.get_count_subscribers)

    def count_clients(self, service_name: str) -> int:
        """Count the clients of a service, which is expanded but not remapped.

        Raises ValueError for a bad name.
        """
        with self.handle:
            return self.__count(service_name, self.handle.get_count_clients, is_service=True)

    def count_services(self, service_name: str) -> int:
        """Count the servers of a service, which is expanded but not remapped.

        Raises ValueError for a bad name.
        """
        with self.handle:
            return self.__count(service_name, self.handle.get_count_services, is_service=True)

    def __count(self, name: str, count: Callable[[str], int], *, is_service: bool = False) -> int:
        return count(self.__expand_valid(name, is_service=is_service))

    def __expand_valid(self, name: str, *, is_service: bool = False) -> str:
        full_name = rclpy.node.expand_topic_name(name, self.get_name(), self.get_namespace())
        rclpy.node.validate_full_topic_name(full_name, is_service=is_service)
        return full_name

    def get_publishers_info_by_topic(
        self, topic_name: str, no_mangle: bool = False
    ) -> list[TopicEndpointInfo]:
        """Describe the publishers of a topic; its name is expanded and remapped unless `no_mangle`."""
        return self._get_info_by_topic(topic_name, no_mangle, _rclpy.rclpy_get_publishers_info_by_topic)

    def get_subscriptions_info_by_topic(
        self, topic_name: str, no_mangle: bool = False
    ) -> list[TopicEndpointInfo]:
        """Describe the subscriptions of a topic; its name is expanded and remapped unless `no_mangle`."""
        return self._get_info_by_topic(topic_name, no_mangle, _rclpy.rclpy_get_subscriptions_info_by_topic)

    def _get_info_by_topic(
        self, topic_name: str, no_mangle: bool, query: Callable[[Any, str, bool], list[dict[str, Any]]]
    ) -> list[TopicEndpointInfo]:
        with self.handle:
            if not no_mangle:
                topic_name = _rclpy.rclpy_remap_topic_name(self.handle, self.__expand_valid(topic_name))
            return [
                rclpy.node.TopicEndpointInfo(**info) for info in query(self.handle, topic_name, no_mangle)
            ]

    def wait_for_node(self, fully_qualified_node_name: str, timeout: float) -> bool:
        """Wait up to `timeout` [s] until a node is there; False if it does not come."""
        if not fully_qualified_node_name.startswith("/"):
            fully_qualified_node_name = f"/{fully_qualified_node_name}"
        if timeout <= 0:
            return False
        return wait_for_graph(
            self.handle, lambda: fully_qualified_node_name in self.get_fully_qualified_node_names(), timeout
        )
