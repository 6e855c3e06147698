"""The ROS 2 that the local rclpy follows, what newer ones have besides, and where they contradict Jazzy.

Everything that depends on the distribution is in the tables here. `IFGEN_ROS_DISTRO` chooses the profile.
Names and arguments of newer distributions work in every profile. One line, once for each, says that real
rclpy of the chosen one has no such thing. docs/local-transport.md shows these tables.
"""

from __future__ import annotations

import os
from enum import IntEnum
from typing import Final, NamedTuple

from rmw_local.notices import say

VARIABLE: Final = "IFGEN_ROS_DISTRO"


class Distro(IntEnum):
    """The distributions that a program can be written for, in their order."""

    JAZZY = 0
    KILTED = 1
    LYRICAL = 2

    @property
    def title(self) -> str:
        """The name as ROS writes it."""
        return self.name.capitalize()


_JAZZY, _KILTED, _LYRICAL = Distro


class NewerApiError(RuntimeError):
    """A program uses, in strict mode, what the chosen distribution does not have."""


# Each program imports this: dataclasses would take two of its milliseconds.
class Api(NamedTuple):
    """Something that a distribution has and the one before it has not; `release` is that of rclpy or rcl."""

    since: Distro
    subject: str
    release: str = ""


class Change(NamedTuple):
    """A behaviour that is another one from a distribution on."""

    since: Distro
    subject: str
    before: str
    after: str


API: Final[dict[str, Api]] = {
    "content_filter_options": Api(
        _JAZZY,
        "content_filter_options, set_content_filter, get_content_filter, is_cft_enabled",
        "7.1.8",
    ),
    "execute_callback": Api(_JAZZY, "ActionServer without execute_callback, succeed(response)", "7.1.8"),
    "is_spinning": Api(_JAZZY, "Executor.is_spinning, and an error for a second spin", "7.1.9"),
    "wait_for_threads": Api(_JAZZY, "MultiThreadedExecutor.shutdown(wait_for_threads=)", "7.1.12"),
    "action_remapping": Api(_JAZZY, "remapping of actions", "rcl 9.2.8"),
    "init": Api(_KILTED, "rclpy.init() as a context manager"),
    "try_shutdown": Api(_KILTED, "try_shutdown(uninstall_handlers=)"),
    "Context": Api(_KILTED, "an initialised Context as a context manager"),
    "track_node": Api(_KILTED, "Context.track_node() or untrack_node()"),
    "Node": Api(_KILTED, "Node as a context manager"),
    "Publisher": Api(_KILTED, "Publisher as a context manager"),
    "Subscription": Api(_KILTED, "Subscription as a context manager"),
    "Client": Api(_KILTED, "Client as a context manager"),
    "Service": Api(_KILTED, "Service as a context manager"),
    "Timer": Api(_KILTED, "Timer as a context manager"),
    "generics": Api(_KILTED, "a class of rclpy with type arguments at run time, such as Publisher[String],"),
    "TimerInfo": Api(_KILTED, "a timer callback with a TimerInfo"),
    "call_timer_with_info": Api(_KILTED, "Timer.handle.call_timer_with_info()"),
    "Duration": Api(_KILTED, "arithmetic with Duration"),
    "rosout_qos_profile": Api(_KILTED, "Node(rosout_qos_profile=)"),
    "QoSProfile": Api(_KILTED, "QoSProfile with positional arguments"),
    "introspection": Api(_KILTED, "configure_introspection() of an action"),
    "to_datetime": Api(_LYRICAL, "Time.to_datetime()"),
    "endpoint_info": Api(_LYRICAL, "rclpy.endpoint_info"),
    "service_endpoints": Api(_LYRICAL, "Node.get_clients_info_by_service() or get_servers_info_by_service()"),
    "action_graph": Api(_LYRICAL, "get_action_names_and_types() of Node"),
    "feedback_filter": Api(_LYRICAL, "ActionClient(enable_feedback_msg_optimization=)"),
    "buffer_backends": Api(_LYRICAL, "create_subscription(acceptable_buffer_backends=)"),
    "every_clock": Api(_LYRICAL, "Clock.ros_time_is_active or set_ros_time_override(), but for a ROSClock"),
    "publisher_class": Api(_LYRICAL, "create_lifecycle_publisher(publisher_class=)"),
    "on_new_callbacks": Api(_LYRICAL, "set_on_new_message_callback() of a handle, or its kin"),
    "executing": Api(_LYRICAL, "ServerGoalHandle.executing()"),
    "asyncio": Api(_LYRICAL, "rclpy.experimental.AsyncNode and what it makes"),
}
"""By the name that `uses` gets."""

CHANGES: Final[dict[str, Change]] = {
    "call_timeout": Change(_KILTED, "`Client.call(timeout_sec=)`, no response", "None", "TimeoutError"),
    "task_order": Change(_KILTED, "tasks of one round", "newest first", "oldest first"),
    "result_timeout": Change(_KILTED, "`ActionServer(result_timeout=)`", "900 s", "10 s"),
    "trigger": Change(_KILTED, "illegal `trigger_*` of a lifecycle node", "RCLError", "ERROR, and a warning"),
    "parameter_type": Change(_KILTED, "`Parameter.Type`", "Enum", "IntEnum: `str()` is the number"),
    "qos_exception": Change(
        _KILTED, "`str(InvalidQoSProfileException)`", "with 'Invalid QoSProfile'", "only the message"
    ),
    "qos_keyword": Change(_KILTED, "`QoSProfile(unknown=...)`", "AssertionError", "TypeError"),
    "publisher_gid": Change(_KILTED, "info of a subscription's callback", "as it was", "has `publisher_gid`"),
    "rosout_preset": Change(_KILTED, "`QoSPresetProfiles.ROSOUT_DEFAULT`", "none", "that of /rosout"),
    "node_shutdown": Change(_KILTED, "nodes after `shutdown`", "usable", "destroyed: InvalidHandle"),
    "context_init": Change(
        _KILTED, "`with Context()` without `init`", "initialises it", "so, with a UserWarning"
    ),
    "late_feedback": Change(
        _LYRICAL, "`publish_feedback` of a goal that does not execute", "published", "a warning, dropped"
    ),
    "second_execute": Change(
        _LYRICAL, "`execute` of a goal that executes or has ended", "RCLError", "nothing happens"
    ),
    "old_names": Change(
        _LYRICAL, "`import rclpy.qos_event`, `rclpy.topic_endpoint_info`", "there", "ModuleNotFoundError"
    ),
    "destroy": Change(_LYRICAL, "an entity after its `destroy()`", "its node lists it", "it does not"),
}
"""By the name that `follows` gets."""

_TYPES = "rclpy.impl.interface_protocols"
_SERVICE = dict.fromkeys(("Srv", "SrvRequestT", "SrvResponseT"), _TYPES)
_ACTION = dict.fromkeys(("Action", "FeedbackMessage", "FeedbackT", "GoalT", "ResultT"), _TYPES)
_INFO = {"MessageInfo": "rclpy.impl.newer"}
_INTROSPECTION = {
    "Clock": "rclpy.clock",
    "ServiceIntrospectionState": "rclpy.service_introspection",
}
# The modules of upstream's asyncio, and the class of each.
_ASYNC = {
    "async_client": "AsyncClient",
    "async_clock": "AsyncClock",
    "async_node": "AsyncNode",
    "async_publisher": "AsyncPublisher",
    "async_service": "AsyncService",
    "async_subscription": "AsyncSubscription",
    "async_timer": "AsyncTimer",
}

NAMES: Final[dict[Distro, dict[str, dict[str, str]]]] = {
    _KILTED: {
        "rclpy": {
            "QoSProfile": "rclpy.qos",
            "qos_profile_rosout_default": "rclpy.qos:_qos_profile_rosout_default",
        },
        "rclpy.action.client": {
            **_ACTION,
            **_INTROSPECTION,
            "GetResultServiceResponse": _TYPES,
            "GoalStatusArray": "action_msgs.msg",
            "SendGoalServiceResponse": _TYPES,
            "Time": "builtin_interfaces.msg",
        },
        "rclpy.action.server": {
            **_ACTION,
            **_INTROSPECTION,
            "CancelGoal": "action_msgs.srv",
            "GetResultServiceRequest": _TYPES,
            "GetResultServiceResponse": _TYPES,
            "SendGoalServiceRequest": _TYPES,
            "Task": "rclpy.task",
            "UUID": "unique_identifier_msgs.msg",
        },
        "rclpy.client": _SERVICE,
        "rclpy.exceptions": {"TimerCancelledError": "rclpy.impl.rcl.handle"},
        "rclpy.executors": {
            **_INFO,
            "Msg": _TYPES,
            "TimerCancelledError": "rclpy.impl.rcl.handle",
            "TimerInfo": "rclpy.impl.newer",
        },
        "rclpy.guard_condition": {"CallbackGroup": "rclpy.callback_groups", "Context": "rclpy.context"},
        "rclpy.lifecycle.node": {"MsgT": _TYPES, "RcutilsLogger": "rclpy.impl.rcutils_logger"},
        "rclpy.lifecycle.publisher": {
            "CallbackGroup": "rclpy.callback_groups",
            "MsgT": _TYPES,
            "PublisherEventCallbacks": "rclpy.event_handler",
            "QoSProfile": "rclpy.qos",
        },
        "rclpy.node": {
            **_INFO,
            **_SERVICE,
            "MsgT": _TYPES,
            "RcutilsLogger": "rclpy.impl.rcutils_logger",
            "TimerInfo": "rclpy.impl.newer",
            "qos_profile_rosout_default": "rclpy.qos:_qos_profile_rosout_default",
        },
        "rclpy.parameter_client": {**_INFO, "Client": "rclpy.client"},
        "rclpy.parameter_event_handler": {"ParameterMsg": "rcl_interfaces.msg:Parameter"},
        "rclpy.publisher": {"MsgT": _TYPES},
        "rclpy.qos": {"qos_profile_rosout_default": "rclpy.qos:_qos_profile_rosout_default"},
        "rclpy.serialization": {"Msg": _TYPES, "MsgT": _TYPES},
        "rclpy.service": _SERVICE,
        "rclpy.subscription": {**_INFO, "MsgT": _TYPES, "RCLError": "rclpy.impl.rcl.handle"},
        "rclpy.timer": {
            "ClockType": "rclpy.clock",
            "Time": "rclpy.time",
            "TimerInfo": "rclpy.impl.newer",
        },
        "rclpy.type_support": {
            **_ACTION,
            **_SERVICE,
            **dict.fromkeys(
                (
                    "ActionT",
                    "CommonMsgSrvMetaClass",
                    "EventMessage",
                    "GetResultService",
                    "GetResultServiceRequest",
                    "GetResultServiceResponse",
                    "Msg",
                    "MsgMetaClass",
                    "MsgT",
                    "PyCapsule",
                    "SendGoalService",
                    "SendGoalServiceRequest",
                    "SendGoalServiceResponse",
                    "SrvT",
                ),
                _TYPES,
            ),
            "ServiceEventInfo": "service_msgs.msg",
            "Time": "builtin_interfaces.msg",
            "UUID": "unique_identifier_msgs.msg",
        },
        "rclpy.wait_for_message": {"MsgT": _TYPES},
    },
    _LYRICAL: {
        "rclpy.exceptions": {"TimeSourceChangedError": "rclpy_asyncio"},
        "rclpy.experimental": dict.fromkeys(_ASYNC.values(), "rclpy_asyncio"),
        **{f"rclpy.experimental.{module}": {name: "rclpy_asyncio"} for module, name in _ASYNC.items()},
        "rclpy.client": {"BaseClient": "rclpy.client:_BaseClient"},
        "rclpy.clock": {"BaseClock": "rclpy.clock:_BaseClock"},
        "rclpy.node": {"BaseNode": "rclpy.node:_BaseNode", "ServiceEndpointInfo": "rclpy.impl.newer"},
        "rclpy.publisher": {"BasePublisher": "rclpy.publisher:_BasePublisher"},
        "rclpy.service": {"BaseService": "rclpy.service:_BaseService"},
        "rclpy.subscription": {"BaseSubscription": "rclpy.subscription:_BaseSubscription"},
        "rclpy.timer": {"BaseTimer": "rclpy.timer:_BaseTimer"},
    },
}
"""Names of modules: where each is defined (`:` if it has another name there), or nothing if we lack it."""


def _chosen() -> Distro:
    """The profile that the environment chooses. A word that is none is reported and ignored."""
    wish = os.environ.get(VARIABLE, "")
    names = [each.name.lower() for each in Distro]
    if wish and wish not in names:
        say(f"{VARIABLE}={wish!r} is not known and ignored; it can be {', '.join(names[:-1])} or {names[-1]}")
        wish = ""
    return Distro[wish.upper()] if wish else Distro.JAZZY


PROFILE: Distro = _chosen()
_followed = {name for name, change in CHANGES.items() if change.since <= PROFILE}

# Strict mode of our pytest plugin switches it on; then newer API is an error.
strict = False

_reported: set[str] = set()


def follows(change: str) -> bool:
    """Whether the profile behaves as from this change on."""
    return change in _followed


def uses(name: str) -> None:
    """Report once that a program uses newer API than the profile has; NewerApiError in strict mode."""
    api = API[name]
    if api.since > PROFILE:
        _report(api.subject, api.since)


def _report(subject: str, since: Distro) -> None:
    text = f"{subject} is ROS 2 {since.title}'s; real {PROFILE.title} will refuse it"
    advice = f"set {VARIABLE}={since.name.lower()} if the program is for that ROS"
    if strict:
        raise NewerApiError(f"{text}: {advice}")
    if subject not in _reported:
        _reported.add(subject)
        say(f"{text} ({advice})")


def home_of(module: str, name: str) -> str:
    """Return the home of a name that newer distributions have in a module; empty if there is none.

    Reports it once if the profile has no such name, or if we have none.
    """
    for since, modules in NAMES.items():
        home = modules.get(module, {}).get(name)
        if home is None:
            continue
        if home and since > PROFILE:
            _report(f"{module}.{name}", since)
        elif not home and name not in _reported:
            _reported.add(name)
            say(f"{module}.{name} is ROS 2 {since.title}'s; the local transport does not have it")
        return home
    return ""
