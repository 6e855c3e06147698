"""The meaning of a node description: every type exists, every default has passed its own validators.

All values are frozen. Equality ignores spans. Terms and defaults are those of NoDL v2 and
generate_parameter_library; the keys below `codegen.ifgen` are ours (docs/nodes.md).
"""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import StrEnum
from pathlib import Path
from typing import Literal, TypeAlias

from ifgen.definition.interfaces import Registry
from ifgen.diagnostics import Diagnostic, Source, Span
from ifgen.reading.package_xml import Dependency

Style = Literal["callbacks", "lifecycle", "asyncio", "nodl"]
"""The kind of a node class: a plain Node, a LifecycleNode, or a Node whose callbacks are coroutines.

With `nodl` it has the names that nodl_generator_py gives: `pub_ID`, `on_ID`, `execute_ID`, `param_listener_`.
"""

MismatchPolicy = Literal["warn", "refuse", "adapt"]

ClockName = Literal["ros", "steady", "system"]
ScalarValue: TypeAlias = bool | int | float | str
ParameterValue: TypeAlias = ScalarValue | tuple[ScalarValue, ...] | bytes
"""`bytes` for a byte_array, a tuple for the other arrays."""


class Category(StrEnum):
    """The six lists of endpoints, under their keys in the document."""

    PUBLISHER = "publishers"
    SUBSCRIPTION = "subscriptions"
    SERVICE_SERVER = "service_servers"
    SERVICE_CLIENT = "service_clients"
    ACTION_SERVER = "action_servers"
    ACTION_CLIENT = "action_clients"

    @property
    def folder(self) -> Literal["msg", "srv", "action"]:
        """The folder of the interfaces of its endpoints: the middle part of their type names."""
        match self:
            case Category.PUBLISHER | Category.SUBSCRIPTION:
                return "msg"
            case Category.SERVICE_SERVER | Category.SERVICE_CLIENT:
                return "srv"
            case _:
                return "action"

    @property
    def singular(self) -> str:
        """The name for one of its endpoints: `publisher`, `service server`."""
        return self.value.removesuffix("s").replace("_", " ")


@dataclass(frozen=True, slots=True)
class QosProfile:
    """A QoS profile. `depth` is 0 and a policy None where the description leaves it open; 0 ns = not set."""

    history: Literal["KEEP_LAST", "KEEP_ALL", "SYSTEM_DEFAULT"]
    reliability: Literal["RELIABLE", "BEST_EFFORT", "SYSTEM_DEFAULT", "BEST_AVAILABLE"]
    depth: int = 0
    durability: Literal["TRANSIENT_LOCAL", "VOLATILE", "SYSTEM_DEFAULT", "BEST_AVAILABLE"] | None = None
    deadline_ns: int = 0
    lifespan_ns: int = 0
    liveliness: Literal["AUTOMATIC", "MANUAL_BY_TOPIC", "SYSTEM_DEFAULT", "BEST_AVAILABLE"] | None = None
    liveliness_lease_duration_ns: int = 0
    span: Span | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Endpoint:
    """An endpoint: its name as written (absolute, relative or `~/private`) and its full type name.

    Topics always have a `qos`, services may have one, actions never do.
    """

    category: Category
    name: str
    type_name: str
    description: str = ""
    qos: QosProfile | None = None
    span: Span | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class ParameterType:
    """A parameter's type without its spelling: `string_array_fixed_4` is `string`, array, at most 4.

    `base` is "none" for a parameter without a value. `fixed_size` bounds a string's characters or an array's
    elements; None where there is no bound.
    """

    base: Literal["bool", "int", "double", "string", "byte", "none"]
    array: bool = False
    fixed_size: int | None = None


@dataclass(frozen=True, slots=True)
class Validator:
    """A validator, without `<>`: `arguments` is flat, () for none, and the inner list for one_of, subset_of.

    `function` is the dotted path of the Python function that stands for a custom validator (`ns::name`).
    """

    name: str
    arguments: tuple[ScalarValue, ...] = ()
    function: str | None = None
    span: Span | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Parameter:
    """A parameter; `default` is None where the value must be given at start."""

    name: str
    type: ParameterType
    default: ParameterValue | None = None
    description: str = ""
    read_only: bool = False
    additional_constraints: str = ""
    validators: tuple[Validator, ...] = ()
    span: Span | None = field(default=None, compare=False, repr=False)

    @property
    def is_required(self) -> bool:
        """Whether whoever starts the node must give it a value."""
        return self.default is None and self.type.base != "none"


@dataclass(frozen=True, slots=True)
class Timer:
    """A timer of the node, from `codegen.ifgen.timers`.

    Exactly one of `period` (seconds) and `period_parameter` (a double parameter, in seconds) is set; `rate`
    in the document is 1 / period. `publishes` names the publishers that send at this rate.
    """

    name: str
    period: float | None = None
    period_parameter: str | None = None
    clock: ClockName = "ros"
    publishes: tuple[str, ...] = ()
    span: Span | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Terms:
    """A promise or a need beyond the type of an endpoint, from `codegen.ifgen.endpoints`.

    `required`: somebody must be at the other side. `exclusive`: nobody else may publish. `rate` [Hz] is what
    a publisher sends at least, or what a subscription needs. `unit` and `frame` are those of the data.
    `version` is that of the interface: `2.1.0` where it is provided, where it is used the range that is
    accepted, such as `2.1..3`: from 2.1 to any 3.
    """

    required: bool = False
    exclusive: bool = False
    rate: float | None = None
    unit: str = ""
    frame: str = ""
    version: str = ""
    span: Span | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Frames:
    """The coordinate frames that a node broadcasts, as (child, parent), and those that it asks for."""

    broadcasts: tuple[tuple[str, str], ...] = ()
    uses: tuple[str, ...] = ()
    span: Span | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class BaseClass:
    """A class that a node derives from, and its method that makes publishers."""

    module: str
    name: str
    publisher_method: str = "create_publisher"

    @property
    def is_lifecycle(self) -> bool:
        """Whether nodes of this class have a managed lifecycle."""
        return self.publisher_method == "create_lifecycle_publisher"


@dataclass(frozen=True, slots=True)
class Interface:
    """Parameters and endpoints of a node."""

    parameters: tuple[Parameter, ...] = ()
    endpoints: tuple[Endpoint, ...] = ()

    def without(self, other: Interface) -> Interface:
        """The same without those of another."""
        taken = {id(each) for each in (*other.parameters, *other.endpoints)}
        return Interface(
            tuple(each for each in self.parameters if id(each) not in taken),
            tuple(each for each in self.endpoints if id(each) not in taken),
        )

    def __add__(self, other: Interface) -> Interface:
        """Both together."""
        return Interface(self.parameters + other.parameters, self.endpoints + other.endpoints)


@dataclass(frozen=True, slots=True)
class NodeDescription:
    """One node: what its file and everything that this includes say, and where it comes from.

    `name` is the file's name without `.nodl.yaml`. `node_class` and `business_file` (the user's module) are
    always set: `GaitPlanner` and `gait_planner.py` for `gait_planner` unless `codegen.ifgen` says otherwise.
    `tests` names the groups of tests to generate; None stands for all that the node has a use for.

    `base` is the class to derive from where an included document names one. `inherited` is what is behind
    such documents, `reserved` what the node declares although rclpy makes it: nothing is generated for
    either. `references` are the `nodl://` names of those documents, `codegen` is what the document says to
    other tools, as (tool, JSON). `terms` are by the names of endpoints, as written.
    """

    package: str
    name: str
    description: str
    style: Style
    node_class: str
    business_file: str
    parameters: tuple[Parameter, ...]
    publishers: tuple[Endpoint, ...]
    subscriptions: tuple[Endpoint, ...]
    service_servers: tuple[Endpoint, ...]
    service_clients: tuple[Endpoint, ...]
    action_servers: tuple[Endpoint, ...]
    action_clients: tuple[Endpoint, ...]
    timers: tuple[Timer, ...] = ()
    tests: tuple[str, ...] | None = None
    on_type_mismatch: MismatchPolicy | None = None
    base: BaseClass | None = None
    inherited: Interface = Interface()
    reserved: Interface = Interface()
    references: tuple[str, ...] = ()
    codegen: tuple[tuple[str, str], ...] = ()
    terms: tuple[tuple[str, Terms], ...] = ()
    frames: Frames = Frames()
    path: Path | None = field(default=None, compare=False, repr=False)
    span: Span | None = field(default=None, compare=False, repr=False)

    @property
    def endpoints(self) -> tuple[Endpoint, ...]:
        """All endpoints, category by category."""
        return (
            *self.publishers,
            *self.subscriptions,
            *self.service_servers,
            *self.service_clients,
            *self.action_servers,
            *self.action_clients,
        )

    @property
    def whole(self) -> Interface:
        """Everything that a running node has, what it inherits and what rclpy makes included."""
        return Interface(self.parameters, self.endpoints) + self.reserved + self.inherited


@dataclass(frozen=True, slots=True)
class PackageMetadata:
    """The contents of a package.xml; empty where it has none."""

    version: str = ""
    description: str = ""
    maintainer_name: str = ""
    maintainer_email: str = ""
    license: str = ""
    dependencies: tuple[Dependency, ...] = ()


@dataclass(frozen=True, slots=True)
class NodePackage:
    """The nodes of one package, by name, and the folder that they come from.

    `sources` is every document that was read for them, included ones too; `metadata` is None where there
    is no package.xml. `parts` are documents for classes that exist: they are installed, so that others can
    include them, but nothing is generated for them.
    """

    name: str
    root: Path
    nodes: tuple[NodeDescription, ...]
    metadata: PackageMetadata | None = None
    sources: tuple[Source, ...] = field(default=(), compare=False, repr=False)
    parts: tuple[NodeDescription, ...] = ()


@dataclass(frozen=True, slots=True)
class Nodes:
    """The nodes of the packages asked for; `registry` has every interface that an endpoint names."""

    packages: tuple[NodePackage, ...]
    registry: Registry
    warnings: tuple[Diagnostic, ...] = field(default=(), compare=False, repr=False)


def qos_mismatch(offered: QosProfile, requested: QosProfile) -> str | None:
    """The reason why an offered profile does not satisfy a requested one; None if it does, or may.

    A policy that a profile leaves to the middleware may turn out either way, so it is no mismatch; deadline,
    lifespan and lease of 0 ns stand for infinite. Source: REP-2003, DDS 1.4 section 2.2.3.
    """
    if offered.reliability == "BEST_EFFORT" and requested.reliability == "RELIABLE":
        return "BEST_EFFORT is offered, RELIABLE requested"
    # rmw's default durability is volatile.
    if (offered.durability or "VOLATILE") == "VOLATILE" and requested.durability == "TRANSIENT_LOCAL":
        return "VOLATILE is offered, TRANSIENT_LOCAL requested"
    if requested.deadline_ns and not 0 < offered.deadline_ns <= requested.deadline_ns:
        what = f"a deadline of {_ms(offered.deadline_ns)}" if offered.deadline_ns else "no deadline"
        return f"{what} is offered, one of {_ms(requested.deadline_ns)} requested"
    if (offered.liveliness or "AUTOMATIC") == "AUTOMATIC" and requested.liveliness == "MANUAL_BY_TOPIC":
        return "AUTOMATIC liveliness is offered, MANUAL_BY_TOPIC requested"
    lease, asked = offered.liveliness_lease_duration_ns, requested.liveliness_lease_duration_ns
    if asked and not 0 < lease <= asked:
        what = f"a lease of {_ms(lease)}" if lease else "no lease"
        return f"{what} is offered, one of {_ms(asked)} requested"
    return None


def _ms(nanoseconds: int) -> str:
    return f"{nanoseconds / 1e6:g} ms"
