"""Checks that a class is the class of a ROS message or service."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rmw_local.message import is_message_class, is_service_class

from rclpy.exceptions import NoTypeSupportImportedException
from rclpy.impl.reexports import reexport

if TYPE_CHECKING:
    from rclpy.impl.interface_protocols import Action as Action  # noqa: PLC0414 - programs import these from here
    from rclpy.impl.interface_protocols import ActionT as ActionT  # noqa: PLC0414
    from rclpy.impl.interface_protocols import FeedbackT as FeedbackT  # noqa: PLC0414
    from rclpy.impl.interface_protocols import GoalT as GoalT  # noqa: PLC0414
    from rclpy.impl.interface_protocols import Msg as Msg  # noqa: PLC0414
    from rclpy.impl.interface_protocols import MsgT as MsgT  # noqa: PLC0414
    from rclpy.impl.interface_protocols import ResultT as ResultT  # noqa: PLC0414
    from rclpy.impl.interface_protocols import Srv as Srv  # noqa: PLC0414
    from rclpy.impl.interface_protocols import SrvRequestT as SrvRequestT  # noqa: PLC0414
    from rclpy.impl.interface_protocols import SrvResponseT as SrvResponseT  # noqa: PLC0414
    from rclpy.impl.interface_protocols import SrvT as SrvT  # noqa: PLC0414
else:
    __getattr__ = reexport(__name__)

_HINT = (
    " This might be a ROS 1 message type but it should be a ROS 2 message type."
    " Make sure to source your ROS 2 workspace after your ROS 1 workspace."
)


def check_for_type_support(msg_or_srv_type: Any) -> None:
    """Refuse what is not the class of a ROS 2 interface.

    Raises AttributeError for any other class, NoTypeSupportImportedException if its package was not built.
    """
    metaclass = msg_or_srv_type.__class__
    try:
        type_support = metaclass._TYPE_SUPPORT
    except AttributeError as error:
        error.args = (f"{error.args[0]}{_HINT}", *error.args[1:])
        raise
    # Compiled type support is not needed here: knowing the fields is enough.
    if type_support is not None or _is_interface(msg_or_srv_type):
        return
    metaclass.__import_type_support__()
    if metaclass._TYPE_SUPPORT is None:
        raise NoTypeSupportImportedException


def check_is_valid_msg_type(msg_type: Any) -> None:
    """Refuse what is not a message class.

    Raises RuntimeError for services and actions, else as `check_for_type_support`.
    """
    check_for_type_support(msg_type)
    if not is_message_class(msg_type):
        raise RuntimeError(
            f"The message type provided is not valid ({msg_type}), this might be a service or action"
        )


def check_is_valid_srv_type(srv_type: Any) -> None:
    """Refuse what is not a service class.

    Raises RuntimeError for messages and actions, else as `check_for_type_support`.
    """
    check_for_type_support(srv_type)
    if not is_service_class(srv_type):
        raise RuntimeError(
            f"The service type provided is not valid ({srv_type}), this might be a message or action"
        )


def _class_of(msg_type: Any) -> Any:
    """The class, where a message is given in its place: upstream takes that, too."""
    return msg_type if isinstance(msg_type, type) else msg_type.__class__


def _is_interface(cls: Any) -> bool:
    return is_message_class(cls) or is_service_class(cls) or getattr(cls, "Goal", None) is not None
