"""From descriptions of nodes to the nodes of `ifgen.model`."""

from __future__ import annotations

from ifgen import model
from ifgen.nodl.model import (
    Endpoint,
    NodeDescription,
    Parameter,
    QosProfile,
    Timer,
    Validator,
)
from ifgen.nodl.names import expanded
from ifgen.nodl.values import spelled as spelled_type
from ifgen.nodl.yaml_lines import yaml_value


def node_model(node: NodeDescription) -> model.Node:
    """The node as generators see it."""

    def views(endpoints: tuple[Endpoint, ...]) -> tuple[model.Endpoint, ...]:
        return tuple(_endpoint(endpoint, node.name) for endpoint in endpoints)

    return model.Node(
        package=node.package,
        name=node.name,
        node_class=node.node_class,
        style=node.style,
        documentation=node.description,
        parameters=tuple(map(_parameter, node.parameters)),
        endpoints=views(node.endpoints),
        publishers=views(node.publishers),
        subscriptions=views(node.subscriptions),
        service_servers=views(node.service_servers),
        service_clients=views(node.service_clients),
        action_servers=views(node.action_servers),
        action_clients=views(node.action_clients),
        timers=tuple(map(_timer, node.timers)),
    )


def _endpoint(endpoint: Endpoint, node: str) -> model.Endpoint:
    return model.Endpoint(
        category=endpoint.category.value,
        name=endpoint.name,
        full_name=expanded(endpoint.name, node),
        type_name=endpoint.type_name,
        documentation=endpoint.description,
        qos=None if endpoint.qos is None else _qos(endpoint.qos),
    )


def _qos(qos: QosProfile) -> model.Qos:
    return model.Qos(
        history=qos.history,
        depth=qos.depth or None,
        reliability=qos.reliability,
        durability=qos.durability,
        deadline=_seconds(qos.deadline_ns),
        lifespan=_seconds(qos.lifespan_ns),
        liveliness=qos.liveliness,
        liveliness_lease_duration=_seconds(qos.liveliness_lease_duration_ns),
    )


def _seconds(nanoseconds: int) -> float | None:
    return nanoseconds / 1e9 if nanoseconds else None


def _parameter(parameter: Parameter) -> model.Parameter:
    constraints = [_constraint(validator) for validator in parameter.validators]
    if parameter.additional_constraints:
        constraints.append(parameter.additional_constraints)
    return model.Parameter(
        name=parameter.name,
        type=spelled_type(parameter.type),
        default=None if parameter.default is None else yaml_value(parameter.default),
        documentation=parameter.description,
        read_only=parameter.read_only,
        constraints=tuple(constraints),
    )


def _constraint(validator: Validator) -> str:
    return f"{validator.name}<>: {yaml_value(validator.arguments)}"


def _timer(timer: Timer) -> model.Timer:
    return model.Timer(
        name=timer.name,
        period=timer.period,
        period_parameter=timer.period_parameter,
        publishes=timer.publishes,
    )
