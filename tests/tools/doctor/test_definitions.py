"""What the graph tells of definitions, also where a middleware tells less than DDS does."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

from ifgen_tools.doctor.definitions import User, disagreements, users, whole, without_hash
from ifgen_tools.ros_graph import read, service_parts

A, B, NONE = "RIHS01_" + "a" * 64, "RIHS01_" + "b" * 64, "INVALID"


def info(node: str, type_name: str, type_hash: str, gid: int = 0) -> Any:
    namespace, _, name = node.rpartition("/")
    values = {"node_name": name, "node_namespace": namespace or "/", "topic_type": type_name}
    qos = SimpleNamespace(name="UNKNOWN")
    duration = SimpleNamespace(nanoseconds=0)
    profile = SimpleNamespace(
        **dict.fromkeys(("history", "reliability", "durability", "liveliness"), qos),
        **dict.fromkeys(("deadline", "lifespan", "liveliness_lease_duration"), duration),
        depth=0,
    )
    return SimpleNamespace(**values, topic_type_hash=type_hash, endpoint_gid=[gid], qos_profile=profile)


class Graph:
    """A node of rclpy that sees these ends, by topic of ROS and by topic of DDS, and these services."""

    def __init__(
        self,
        topics: dict[str, tuple[list[Any], list[Any]]],
        dds: dict[str, tuple[list[Any], list[Any]]] | None = None,
        services: dict[str, list[tuple[str, list[str]]]] | None = None,
    ) -> None:
        self._topics, self._dds, self._services = topics, dds or {}, services or {}

    def get_fully_qualified_name(self) -> str:
        return "/_me"

    def get_node_names_and_namespaces(self) -> list[tuple[str, str]]:
        return [("_me", "/"), ("arm", "/left"), ("arm", "/right"), ("eye", "/"), ("_hidden", "/")]

    def get_topic_names_and_types(self, no_demangle: bool = False) -> list[tuple[str, list[str]]]:
        return [(name, []) for name in (self._dds if no_demangle else self._topics)]

    def get_publishers_info_by_topic(self, topic: str, no_mangle: bool = False) -> list[Any]:
        return (self._dds if no_mangle else self._topics)[topic][0]

    def get_subscriptions_info_by_topic(self, topic: str, no_mangle: bool = False) -> list[Any]:
        return (self._dds if no_mangle else self._topics)[topic][1]

    def get_service_names_and_types_by_node(self, name: str, namespace: str) -> list[tuple[str, list[str]]]:
        return self._services.get(f"{namespace.rstrip('/')}/{name}", [])

    def get_client_names_and_types_by_node(self, name: str, namespace: str) -> list[tuple[str, list[str]]]:
        return []


def used(graph: Graph, service_hashes: dict[tuple[int, ...], str] | None = None) -> tuple[User, ...]:
    node: Any = graph
    return users(read(node), service_parts(node), service_hashes or {})


def seen(graph: Graph) -> list[tuple[str, str, dict[tuple[str, str | None], list[str]]]]:
    """Kind, name, and the nodes by version."""
    found = used(graph)
    return [
        (each.kind, each.name, {tuple(v): [u.node for u in having] for v, having in each.versions.items()})
        for each in disagreements(found)
    ]


def test_one_publisher_of_many_differs() -> None:
    arms = [info("/left/arm", "a/msg/B", A), info("/right/arm", "a/msg/B", B)]
    graph = Graph({"/x": (arms, [info("/eye", "a/msg/B", A)]), "/y": (arms[:1], [])})
    assert seen(graph) == [
        ("topic", "/x", {("a/msg/B", A): ["/left/arm", "/eye"], ("a/msg/B", B): ["/right/arm"]})
    ]


def test_hidden_nodes_and_topics_do_not_count() -> None:
    ends = ([info("/eye", "a/msg/B", A)], [info("/_hidden", "a/msg/B", B)])
    differing = ([info("/eye", "a/msg/B", A)], [info("/left/arm", "a/msg/B", B)])
    assert seen(Graph({"/x": ends, "/_ifgen": differing, "/set/_service_event": differing})) == []


def test_topics_within_services_and_actions_have_their_names() -> None:
    def ends(type_name: str) -> tuple[list[Any], list[Any]]:
        return [info("/eye", type_name, A)], [info("/left/arm", type_name, B)]

    graph = Graph(
        {"/walk/_action/feedback": ends("a/action/Walk_FeedbackMessage")},
        {
            "rq/setRequest": ends("a::srv::dds_::Set_Request_"),
            "rr/walk/_action/get_resultReply": ends("a::action::dds_::Walk_GetResult_Response_"),
        },
    )
    assert [(kind, name, *versions) for kind, name, versions in seen(graph)] == [
        ("action", "/walk", ("a/action/Walk_FeedbackMessage", A), ("a/action/Walk_FeedbackMessage", B)),
        (
            "action",
            "/walk",
            ("a/action/Walk_GetResult_Response", A),
            ("a/action/Walk_GetResult_Response", B),
        ),
        ("service", "/set", ("a/srv/Set_Request", A), ("a/srv/Set_Request", B)),
    ]
    found = used(graph)
    assert {(user.node, user.role) for user in found} == {
        ("/eye", "action server"),
        ("/left/arm", "action client"),
        ("/eye", "service client"),
        ("/left/arm", "service server"),
    }


def test_different_services_of_one_name_are_told_once() -> None:
    def ends(part: str) -> tuple[list[Any], list[Any]]:
        return [info("/eye", f"a::srv::dds_::Set_{part}_", A)], [
            info("/left/arm", f"a::srv::dds_::Get_{part}_", B)
        ]

    graph = Graph({}, {"rq/setRequest": ends("Request"), "rr/setReply": ends("Response")})
    assert [(kind, name) for kind, name, _ in seen(graph)] == [("service", "/set")]


def test_where_services_are_no_topics_their_types_are_compared_by_name() -> None:
    services = {"/eye": [("/set", ["a/srv/Set"])], "/left/arm": [("/set", ["a/srv/Get"])]}
    assert seen(Graph({}, services=services)) == [
        ("service", "/set", {("a/srv/Get", None): ["/left/arm"], ("a/srv/Set", None): ["/eye"]})
    ]
    same = {"/eye": [("/set", ["a/srv/Set"])], "/left/arm": [("/set", ["a/srv/Set"])]}
    assert seen(Graph({}, services=same)) == []


def test_a_node_without_hashes_is_named_and_disagrees_with_nobody() -> None:
    ends = ([info("/eye", "a/msg/B", A)], [info("/left/arm", "a/msg/B", NONE)])
    graph = Graph({"/x": ends, "/y": ends})
    assert seen(graph) == []
    assert without_hash(used(graph)) == ["/left/arm"]


def test_whole_services_are_compared_where_a_part_is_unknown() -> None:
    def ends(part: str, known: str) -> tuple[list[Any], list[Any]]:
        name = f"a::srv::dds_::Set_{part}_"
        return [info("/eye", name, known, 1)], [
            info("/left/arm", name, NONE, 2),
            info("/right/arm", name, NONE, 3),
        ]

    graph = Graph({}, {"rq/setRequest": ends("Request", A), "rr/setReply": ends("Response", B)})
    same = used(graph, {(gid,): A for gid in (1, 2, 3)})
    assert disagreements(same) == [] and without_hash(same) == []
    differing = used(graph, {(1,): A, (2,): A, (3,): B})
    (found,) = disagreements(differing)
    assert {tuple(v): sorted({u.node for u in having}) for v, having in found.versions.items()} == {
        ("a/srv/Set", A): ["/eye", "/left/arm"],
        ("a/srv/Set", B): ["/right/arm"],
    }
    assert found.type_names == ["a/srv/Set"]
    assert without_hash(used(graph)) == ["/left/arm", "/right/arm"]
    partial = {(gid,): A for gid in (1, 2)}  # the third one has just come
    assert without_hash(used(graph, partial)) == ["/left/arm", "/right/arm"]


def test_a_part_of_an_action_without_request_or_response_belongs_to_it() -> None:
    assert whole("a/action/Walk_SendGoal") == whole("a/action/Walk_GetResult_Response") == "a/action/Walk"
    assert whole("a/srv/Set_Request") == "a/srv/Set"
