"""Tests of what launch descriptions start: unittest cases that run beside the processes, and after them."""

from launch_testing import actions as actions
from launch_testing import asserts as asserts
from launch_testing import markers as markers
from launch_testing import tools as tools
from launch_testing import util as util
from launch_testing.io_handler import ActiveIoHandler, IoHandler
from launch_testing.loader import parametrize, post_shutdown_test, ready_to_test_action_timeout
from launch_testing.proc_info_handler import ActiveProcInfoHandler, ProcInfoHandler

__all__ = [
    "ActiveIoHandler",
    "ActiveProcInfoHandler",
    "IoHandler",
    "ProcInfoHandler",
    "actions",
    "asserts",
    "markers",
    "parametrize",
    "post_shutdown_test",
    "ready_to_test_action_timeout",
    "tools",
    "util",
]
