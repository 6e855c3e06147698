"""From node descriptions to what templates of the user's own see of them."""

from __future__ import annotations

from ifgen.generator_py.outputs.view import EndpointView, NodeView, ParameterView, QosView, TimerView
from ifgen.nodl.model import (
    Endpoint,
    NodeDescription,
    Parameter,
    ParameterType,
    ParameterValue,
    QosProfile,
    ScalarValue,
    Timer,
    Validator,
)
from ifgen.nodl.names import expanded


def node_view(node: NodeDescription) -> NodeView:
    """The view of a node for templates."""

    def views(endpoints: tuple[Endpoint, ...]) -> tuple[EndpointView, ...]:
        return tuple(_endpoint(endpoint, node.name) for endpoint in endpoints)

    return NodeView(
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


def _endpoint(endpoint: Endpoint, node: str) -> EndpointView:
    return EndpointView(
        category=endpoint.category.value,
        name=endpoint.name,
        full_name=expanded(endpoint.name, node),
        type_name=endpoint.type_name,
        documentation=endpoint.description,
        qos=None if endpoint.qos is None else _qos(endpoint.qos),
    )


def _qos(qos: QosProfile) -> QosView:
    return QosView(
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


def _parameter(parameter: Parameter) -> ParameterView:
    constraints = [_validator(validator) for validator in parameter.validators]
    if parameter.additional_constraints:
        constraints.append(parameter.additional_constraints)
    return ParameterView(
        name=parameter.name,
        type=_type(parameter.type),
        default=None if parameter.default is None else _yaml(parameter.default),
        documentation=parameter.description,
        read_only=parameter.read_only,
        constraints=tuple(constraints),
    )


def _type(type_: ParameterType) -> str:
    text = f"{type_.base}_array" if type_.array else type_.base
    return text if type_.fixed_size is None else f"{text}_fixed_{type_.fixed_size}"


def _validator(validator: Validator) -> str:
    return f"{validator.name}<>: {_yaml(validator.arguments)}"


def _yaml(value: ParameterValue) -> str:
    if isinstance(value, tuple | bytes):
        return f"[{', '.join(map(_scalar, value))}]"
    return _scalar(value)


def _scalar(value: ScalarValue) -> str:
    match value:
        case bool():
            return "true" if value else "false"
        case str():
            escaped = value.replace("\\", "\\\\").replace('"', '\\"')
            return f'"{escaped}"'
        case float() if value - value != 0.0:  # inf or nan
            return {"inf": ".inf", "-inf": "-.inf"}.get(str(value), ".nan")
        case _:
            return str(value)


def _timer(timer: Timer) -> TimerView:
    return TimerView(
        name=timer.name,
        period=timer.period,
        period_parameter=timer.period_parameter,
        publishes=timer.publishes,
    )
