"""QoS profiles: how they are made, printed, refused, and which ones match."""

import itertools
import warnings

import rclpy
from rclpy import qos
from rclpy.duration import Duration
from rclpy.impl.implementation_singleton import rclpy_implementation as rcl
from rclpy.qos import QoSProfile, qos_check_compatible
from transcript import attempt


def construction() -> None:
    """Arguments that make a profile, and those that do not."""
    for arguments in (
        {},
        {"depth": 3},
        {"history": 1},
        {"history": 2},
        {"history": qos.HistoryPolicy.KEEP_LAST, "depth": 0},
        {"depth": 1, "reliability": 2, "durability": 1, "liveliness": 3},
        {"depth": 1, "lifespan": Duration(seconds=1, nanoseconds=5), "deadline": Duration(seconds=2)},
        {"depth": 1, "reliability": "reliable"},
        {"depth": 1, "reliability": 9},
        {"depth": 1, "deadline": 1.0},
        {"depth": 1.5},
        {"depth": 1, "nope": 2},
        {"depth": 1, "avoid_ros_namespace_conventions": 1},
        {"depth": -1},
    ):
        attempt(f"QoSProfile({sorted(arguments)})", lambda arguments=arguments: QoSProfile(**arguments), str)
    print(QoSProfile(depth=3) == QoSProfile(depth=3), QoSProfile(depth=3) == QoSProfile(depth=4))
    attempt("hash", lambda: hash(QoSProfile(depth=1)))
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        QoSProfile(depth=0)
        print(qos.ReliabilityPolicy.RMW_QOS_POLICY_RELIABILITY_RELIABLE)
        print(qos.LivelinessPolicy.RMW_QOS_POLICY_DURABILITY_UNKNOWN)
    for warning in caught:
        print(warning.category.__name__, warning.message)


def names() -> None:
    """Presets, enums and short keys."""
    for preset in qos.QoSPresetProfiles:
        print(preset.name, preset.value)
    print(qos.QoSPresetProfiles.short_keys())
    attempt("preset", lambda: qos.QoSPresetProfiles.get_from_short_key("Sensor_Data"), str)
    attempt("no preset", lambda: qos.QoSPresetProfiles.get_from_short_key("zz"))
    for policy in (qos.HistoryPolicy, qos.ReliabilityPolicy, qos.DurabilityPolicy, qos.LivelinessPolicy):
        print(policy.__name__, policy.short_keys(), [int(value) for value in policy])
        print([value.short_key for value in policy], [repr(value) for value in policy])
        attempt("from key", lambda policy=policy: policy.get_from_short_key("Unknown"))
        attempt("from key", lambda policy=policy: policy.get_from_short_key("nope"))
    print(
        [repr(kind) for kind in qos.QoSPolicyKind], [qos.qos_policy_name_from_kind(1 << n) for n in range(10)]
    )
    attempt("kind", lambda: qos.qos_policy_name_from_kind(3))
    print(qos.DeadlineBestAvailable, qos.LivelinessLeaseDurationeBestAvailable)
    attempt("predefined", lambda: rcl.rmw_qos_profile_t.predefined("nope"))
    attempt("action", lambda: rcl.rclpy_action_get_rmw_qos_profile("nope"))
    print(rcl.rmw_qos_profile_t.predefined("qos_profile_sensor_data").to_dict())
    print(QoSProfile(depth=4, deadline=Duration(seconds=3)).get_c_qos_profile().to_dict())


def check(**policies: tuple[object, object]) -> str:
    """Check an offered against a requested profile."""
    offered = QoSProfile(depth=1, **{name: pair[0] for name, pair in policies.items()})
    requested = QoSProfile(depth=1, **{name: pair[1] for name, pair in policies.items()})
    compatibility, reason = qos_check_compatible(offered, requested)
    return f"{compatibility} {reason}"


def matching() -> None:
    """All pairs of each policy, and several at once."""
    for name, values in (
        ("reliability", range(5)),
        ("durability", range(5)),
        ("liveliness", (0, 1, 3, 4, 5)),
        ("deadline", [Duration(nanoseconds=n) for n in (0, 5, 9, 2**63 - 1)]),
        ("liveliness_lease_duration", [Duration(nanoseconds=n) for n in (0, 5, 9, 2**63 - 1)]),
    ):
        for pair in itertools.product(values, values):
            print(name, *pair, check(**{name: pair}))
    nine, five, none = (Duration(nanoseconds=n) for n in (9, 5, 0))
    print(
        check(
            reliability=(2, 1),
            durability=(2, 1),
            deadline=(nine, five),
            liveliness=(1, 3),
            liveliness_lease_duration=(nine, five),
        )
    )
    print(check(deadline=(none, five), liveliness_lease_duration=(none, five), reliability=(0, 0)))
    print(check(reliability=(0, 1), durability=(0, 1), liveliness=(0, 3)))


def main() -> None:
    """Run every part."""
    rclpy.init()
    construction()
    names()
    matching()
    rclpy.shutdown()
