"""Quality of service: policies, profiles, and whether two profiles match."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from enum import Enum, IntEnum
from typing import TYPE_CHECKING, Any, TypeVar

from rclpy.duration import Duration
from rclpy.impl import distro
from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy
from rclpy.impl.reexports import reexport

if not TYPE_CHECKING:
    __getattr__ = reexport(__name__)


class QoSPolicyKind(IntEnum):
    """The policies, as QoS events name them."""

    INVALID = 1 << 0
    DURABILITY = 1 << 1
    DEADLINE = 1 << 2
    LIVELINESS = 1 << 3
    RELIABILITY = 1 << 4
    HISTORY = 1 << 5
    LIFESPAN = 1 << 6
    DEPTH = 1 << 7
    LIVELINESS_LEASE_DURATION = 1 << 8
    AVOID_ROS_NAMESPACE_CONVENTIONS = 1 << 9


def qos_policy_name_from_kind(policy_kind: QoSPolicyKind | int) -> str:
    """Return the name of a policy: `RELIABILITY`."""
    return QoSPolicyKind(policy_kind).name


class InvalidQoSProfileException(Exception):
    """A profile was made with arguments that do not make one."""

    def __init__(self, *args: Any) -> None:
        super().__init__(*(args if distro.follows("qos_exception") else ("Invalid QoSProfile", *args)))


class QoSPolicyEnum(IntEnum):
    """The base of the policy enums; short keys are the names in lower case, as command lines use them."""

    @classmethod
    def short_keys(cls) -> list[str]:
        """Return the short key of every value."""
        return [name.lower() for name in cls.__members__]

    @classmethod
    def get_from_short_key(cls, name: str) -> int:
        """Return the value for a short key in any case; KeyError for an unknown one."""
        return cls[name.upper()].value

    @property
    def short_key(self) -> str:
        """The value's short key."""
        return self.name.lower()


class _DeprecatedAlias:
    """A long name of a policy value from the days of the C enum: still there, with a warning."""

    def __init__(self, name: str, value_name: str) -> None:
        self._name = name
        self._value_name = value_name

    def __get__(self, instance: object, policy: type[QoSPolicyEnum]) -> QoSPolicyEnum:
        warnings.warn(
            f"{policy.__name__}.{self._name} is deprecated. "
            f"Use {policy.__name__}.{self._value_name} instead.",
            stacklevel=2,
        )
        return policy[self._value_name]


_Policy = TypeVar("_Policy", bound=type[QoSPolicyEnum])


def _with_deprecated_aliases(prefix: str, *value_names: str) -> Callable[[_Policy], _Policy]:
    def add(policy: _Policy) -> _Policy:
        for value_name in value_names:
            alias = f"{prefix}_{value_name}"
            setattr(policy, alias, _DeprecatedAlias(alias, value_name))
        return policy

    return add


@_with_deprecated_aliases("RMW_QOS_POLICY_HISTORY", "SYSTEM_DEFAULT", "KEEP_LAST", "KEEP_ALL", "UNKNOWN")
class HistoryPolicy(QoSPolicyEnum):
    """The limit on waiting messages: the last `depth` or all."""

    SYSTEM_DEFAULT = 0
    KEEP_LAST = 1
    KEEP_ALL = 2
    UNKNOWN = 3


QoSHistoryPolicy = HistoryPolicy


@_with_deprecated_aliases(
    "RMW_QOS_POLICY_RELIABILITY", "SYSTEM_DEFAULT", "RELIABLE", "BEST_EFFORT", "UNKNOWN"
)
class ReliabilityPolicy(QoSPolicyEnum):
    """Whether lost messages are sent again."""

    SYSTEM_DEFAULT = 0
    RELIABLE = 1
    BEST_EFFORT = 2
    UNKNOWN = 3
    BEST_AVAILABLE = 4


QoSReliabilityPolicy = ReliabilityPolicy


@_with_deprecated_aliases(
    "RMW_QOS_POLICY_DURABILITY", "SYSTEM_DEFAULT", "TRANSIENT_LOCAL", "VOLATILE", "UNKNOWN"
)
class DurabilityPolicy(QoSPolicyEnum):
    """Whether subscriptions that come later get earlier messages."""

    SYSTEM_DEFAULT = 0
    TRANSIENT_LOCAL = 1
    VOLATILE = 2
    UNKNOWN = 3
    BEST_AVAILABLE = 4


QoSDurabilityPolicy = DurabilityPolicy


@_with_deprecated_aliases("RMW_QOS_POLICY_LIVELINESS", "SYSTEM_DEFAULT", "AUTOMATIC", "MANUAL_BY_TOPIC")
# Upstream's alias for UNKNOWN has the wrong policy in its name, and programs can only use that.
@_with_deprecated_aliases("RMW_QOS_POLICY_DURABILITY", "UNKNOWN")
class LivelinessPolicy(QoSPolicyEnum):
    """How a publisher shows that it is alive."""

    SYSTEM_DEFAULT = 0
    AUTOMATIC = 1
    MANUAL_BY_TOPIC = 3
    UNKNOWN = 4
    BEST_AVAILABLE = 5


QoSLivelinessPolicy = LivelinessPolicy

# Durations that stand for "whatever matches most endpoints that are there".
DeadlineBestAvailable = Duration(nanoseconds=_rclpy.RMW_QOS_DEADLINE_BEST_AVAILABLE)
LivelinessLeaseDurationeBestAvailable = Duration(
    nanoseconds=_rclpy.RMW_QOS_LIVELINESS_LEASE_DURATION_BEST_AVAILABLE
)


def _predefined(name: str) -> dict[str, Any]:
    return _rclpy.rmw_qos_profile_t.predefined(name).to_dict()


_DEFAULTS = _predefined("qos_profile_default")


class QoSProfile:
    """The policies of an endpoint; history or depth have to be given, the others have defaults.

    Raises InvalidQoSProfileException when they are not, AssertionError for an unknown policy or a value of a
    wrong type.
    """

    __slots__ = [  # noqa: RUF023 - the order in which they print
        "_history",
        "_depth",
        "_reliability",
        "_durability",
        "_lifespan",
        "_deadline",
        "_liveliness",
        "_liveliness_lease_duration",
        "_avoid_ros_namespace_conventions",
    ]

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        unknown = [key for key in kwargs if f"_{key}" not in self.__slots__]
        if unknown and distro.follows("qos_keyword"):
            raise TypeError(f"QoSProfile() got an unexpected keyword argument '{unknown[0]}'")
        assert not unknown, f"Invalid arguments passed to constructor: {kwargs.keys()!r}"
        if args:
            self._take_positional(args, kwargs)
        if distro.follows("qos_keyword"):
            kwargs = {key: value for key, value in kwargs.items() if value is not None}
        if "history" not in kwargs:
            if "depth" not in kwargs:
                raise InvalidQoSProfileException("History and/or depth settings are required.")
            kwargs["history"] = HistoryPolicy.KEEP_LAST
        self.history = kwargs["history"]
        if self.history == HistoryPolicy.KEEP_LAST and "depth" not in kwargs:
            raise InvalidQoSProfileException("History set to KEEP_LAST without a depth setting.")
        policies = {**_DEFAULTS, **kwargs}
        for slot in self.__slots__[1:]:
            setattr(self, slot[1:], policies[slot[1:]])

    def _take_positional(self, args: tuple[Any, ...], kwargs: dict[str, Any]) -> None:
        """Add to the keywords what newer ROS takes by position; None is a default there."""
        if len(args) > len(self.__slots__):
            most = f"from 1 to {1 + len(self.__slots__)} positional arguments"
            expected = most if distro.follows("qos_keyword") else "1 positional argument"
            raise TypeError(f"QoSProfile.__init__() takes {expected} but {1 + len(args)} were given")
        distro.uses("QoSProfile")
        for slot, value in zip(self.__slots__, args, strict=False):
            if slot[1:] in kwargs:
                raise TypeError(f"QoSProfile() got multiple values for argument '{slot[1:]}'")
            if value is not None:
                kwargs[slot[1:]] = value

    @property
    def history(self) -> HistoryPolicy:
        """The limit on waiting messages."""
        return self._history

    @history.setter
    def history(self, value: HistoryPolicy | int) -> None:
        """Set it, also by number. Raises AssertionError for no integer, ValueError for an unknown one."""
        assert isinstance(value, int)
        self._history = HistoryPolicy(value)

    @property
    def reliability(self) -> ReliabilityPolicy:
        """Whether lost messages are sent again."""
        return self._reliability

    @reliability.setter
    def reliability(self, value: ReliabilityPolicy | int) -> None:
        """Set it, also by number. Raises AssertionError for no integer, ValueError for an unknown one."""
        assert isinstance(value, int)
        self._reliability = ReliabilityPolicy(value)

    @property
    def durability(self) -> DurabilityPolicy:
        """Whether subscriptions that come later get earlier messages."""
        return self._durability

    @durability.setter
    def durability(self, value: DurabilityPolicy | int) -> None:
        """Set it, also by number. Raises AssertionError for no integer, ValueError for an unknown one."""
        assert isinstance(value, int)
        self._durability = DurabilityPolicy(value)

    @property
    def depth(self) -> int:
        """The limit on waiting messages if history is KEEP_LAST."""
        return self._depth

    @depth.setter
    def depth(self, value: int) -> None:
        """Set it, with a warning for 0 where history is KEEP_LAST. Raises AssertionError for no integer."""
        assert isinstance(value, int)
        if value == 0 and self.history == HistoryPolicy.KEEP_LAST:
            warnings.warn(
                "A zero depth with KEEP_LAST doesn't make sense; no data could be stored. "
                "This will be interpreted as SYSTEM_DEFAULT",
                stacklevel=2,
            )
        self._depth = value

    @property
    def lifespan(self) -> Duration:
        """The age at which a message is dropped unread."""
        return self._lifespan

    @lifespan.setter
    def lifespan(self, value: Duration) -> None:
        """Set it. Raises AssertionError for what is no Duration."""
        assert isinstance(value, Duration)
        self._lifespan = value

    @property
    def deadline(self) -> Duration:
        """The longest time between two messages."""
        return self._deadline

    @deadline.setter
    def deadline(self, value: Duration) -> None:
        """Set it. Raises AssertionError for what is no Duration."""
        assert isinstance(value, Duration)
        self._deadline = value

    @property
    def liveliness(self) -> LivelinessPolicy:
        """How a publisher shows that it is alive."""
        return self._liveliness

    @liveliness.setter
    def liveliness(self, value: LivelinessPolicy | int) -> None:
        """Set it, also by number. Raises AssertionError for no integer, ValueError for an unknown one."""
        assert isinstance(value, int)
        self._liveliness = LivelinessPolicy(value)

    @property
    def liveliness_lease_duration(self) -> Duration:
        """The time for which a sign of life counts."""
        return self._liveliness_lease_duration

    @liveliness_lease_duration.setter
    def liveliness_lease_duration(self, value: Duration) -> None:
        """Set it. Raises AssertionError for what is no Duration."""
        assert isinstance(value, Duration)
        self._liveliness_lease_duration = value

    @property
    def avoid_ros_namespace_conventions(self) -> bool:
        """Whether the topic has the same name in DDS as in ROS, without a prefix."""
        return self._avoid_ros_namespace_conventions

    @avoid_ros_namespace_conventions.setter
    def avoid_ros_namespace_conventions(self, value: bool) -> None:
        """Set it. Raises AssertionError for what is no bool."""
        assert isinstance(value, bool)
        self._avoid_ros_namespace_conventions = value

    def get_c_qos_profile(self) -> _rclpy.rmw_qos_profile_t:
        """Return the profile as handles take it."""
        return _rclpy.rmw_qos_profile_t(
            self.history,
            self.depth,
            self.reliability,
            self.durability,
            self.lifespan.get_c_duration(),
            self.deadline.get_c_duration(),
            self.liveliness,
            self.liveliness_lease_duration.get_c_duration(),
            self.avoid_ros_namespace_conventions,
        )

    def __eq__(self, other: object) -> bool:
        return isinstance(other, QoSProfile) and all(
            getattr(self, slot) == getattr(other, slot) for slot in self.__slots__
        )

    __hash__ = None  # type: ignore[assignment]  # it can be changed

    def __str__(self) -> str:
        policies = ", ".join(f"{slot[1:]}={getattr(self, slot)}" for slot in self.__slots__)
        return f"{type(self).__name__}({policies})"


#: Every policy unknown: what an endpoint has that nobody described; none can be made with it.
qos_profile_unknown = QoSProfile(**_predefined("qos_profile_unknown"))
qos_profile_default = QoSProfile(**_DEFAULTS)
#: Every policy left to the middleware.
qos_profile_system_default = QoSProfile(**_predefined("qos_profile_system_default"))
#: For sensors: the newest few messages, none sent twice.
qos_profile_sensor_data = QoSProfile(**_predefined("qos_profile_sensor_data"))
#: For services: reliable and volatile, so that a new server does not answer old requests.
qos_profile_services_default = QoSProfile(**_predefined("qos_profile_services_default"))
#: For parameter services: as for services, with a longer queue.
qos_profile_parameters = QoSProfile(**_predefined("qos_profile_parameters"))
#: For /parameter_events.
qos_profile_parameter_events = QoSProfile(**_predefined("qos_profile_parameter_events"))
#: Chosen when the endpoint is made: the strictest that matches most of those that are there then.
qos_profile_best_available = QoSProfile(**_predefined("qos_profile_best_available"))
#: For the status topic of actions: the last one is there for whoever comes.
qos_profile_action_status_default = QoSProfile(
    **_rclpy.rclpy_action_get_rmw_qos_profile("rcl_action_qos_profile_status_default")
)


def _rosout_profile(depth: int) -> QoSProfile:
    """The profile of /rosout, except for the depth."""
    return QoSProfile(depth=depth, durability=DurabilityPolicy.TRANSIENT_LOCAL, lifespan=Duration(seconds=10))


#: For /rosout: what was logged within ten seconds is there for whoever comes.
_qos_profile_rosout_default = _rosout_profile(1000)


class QoSPresetProfiles(Enum):
    """The predefined profiles by name."""

    UNKNOWN = qos_profile_unknown
    DEFAULT = qos_profile_default
    SYSTEM_DEFAULT = qos_profile_system_default
    SENSOR_DATA = qos_profile_sensor_data
    SERVICES_DEFAULT = qos_profile_services_default
    PARAMETERS = qos_profile_parameters
    PARAMETER_EVENTS = qos_profile_parameter_events
    ACTION_STATUS_DEFAULT = qos_profile_action_status_default
    BEST_AVAILABLE = qos_profile_best_available
    if distro.follows("rosout_preset"):
        ROSOUT_DEFAULT = _qos_profile_rosout_default

    @classmethod
    def short_keys(cls) -> list[str]:
        """Return the short key of every profile."""
        return [name.lower() for name in cls.__members__]

    @classmethod
    def get_from_short_key(cls, name: str) -> QoSProfile:
        """Return the profile for a short key in any case; KeyError for an unknown one."""
        return cls[name.upper()].value


QoSCompatibility = _rclpy.QoSCompatibility


def qos_check_compatible(
    publisher_qos: QoSProfile, subscription_qos: QoSProfile
) -> tuple[QoSCompatibility, str]:
    """Say whether endpoints with these profiles can talk, and why not.

    WARNING means that it depends on what the middleware makes of "system default" or "unknown".
    """
    result = _rclpy.rclpy_qos_check_compatible(
        publisher_qos.get_c_qos_profile(), subscription_qos.get_c_qos_profile()
    )
    return result.compatibility, result.reason
