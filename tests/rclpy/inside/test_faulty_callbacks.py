"""A callback that forgets its `return`, raises, is async or destroys its own entity: one sentence, and nobody waits."""

from __future__ import annotations

import os
import signal
import threading
import warnings
from collections.abc import Callable, Iterator
from typing import Any

import pytest
import rclpy
from action_msgs.msg import GoalStatus
from ifgen_runtime import ServerGoneError
from rcl_interfaces.msg import SetParametersResult
from rclpy.action import ActionClient, ActionServer, CancelResponse, GoalResponse
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor, SingleThreadedExecutor
from rclpy.lifecycle import LifecycleNode, TransitionCallbackReturn
from rclpy.parameter import Parameter
from rclpy.task import Future
from std_msgs.msg import String
from std_srvs.srv import Trigger
from test_msgs.action import Fibonacci

ROUNDS = 200  # of 0.05 s at most: the limit of what could hang
SUCCESS, ABORTED, CANCELED = (
    GoalStatus.STATUS_SUCCEEDED,
    GoalStatus.STATUS_ABORTED,
    GoalStatus.STATUS_CANCELED,
)


class Boom(Exception):
    """What callbacks raise."""


class Scene:
    """A server's node, a client's, and an executor that goes on after what callbacks raise."""

    def __init__(self, executor: Any, read_errors: Callable[[], str]) -> None:
        self.executor = executor
        self.node, self.client_node = rclpy.create_node("server"), rclpy.create_node("client")
        self.group = ReentrantCallbackGroup()
        self.raised: list[BaseException] = []
        self._read_errors = read_errors
        self._errors = ""
        executor.add_node(self.node)
        executor.add_node(self.client_node)

    def until(self, condition: Callable[[], object]) -> None:
        for _ in range(ROUNDS):
            if condition():
                return
            try:
                self.executor.spin_once(timeout_sec=0.05)
            except Exception as error:
                self.raised.append(error)
        raise AssertionError("it would wait for ever")

    def answer(self, future: Future) -> Any:
        self.until(future.done)
        return future.exception() or future.result()

    def said(self) -> str:
        self._errors += self._read_errors()
        return self._errors


@pytest.fixture(params=[SingleThreadedExecutor, MultiThreadedExecutor])
def scene(request: pytest.FixtureRequest, capfd: pytest.CaptureFixture[str]) -> Iterator[Scene]:
    rclpy.init()
    arguments = (2,) if request.param is MultiThreadedExecutor else ()
    made = Scene(request.param(*arguments), lambda: capfd.readouterr().err)
    yield made
    made.executor.shutdown()
    made.node.destroy_node()  # else garbage of this test could answer the next one
    made.client_node.destroy_node()
    rclpy.shutdown()


def _faulty(fault: str, good: Callable[..., Any]) -> Callable[..., Any]:
    """A callback with one fault, where `good` is one without."""

    def returns_nothing(*_: Any) -> Any:
        return None

    def returns_a_text(*_: Any) -> Any:
        return "text"

    def raises(*_: Any) -> Any:
        raise Boom

    async def is_async(*arguments: Any) -> Any:
        return good(*arguments)

    async def awaits_what_was_cancelled(*arguments: Any) -> Any:
        future: Future = Future()
        future.cancel()
        await future
        return good(*arguments)

    async def is_async_and_returns_nothing(*_: Any) -> Any:
        return None

    known = (
        returns_nothing,
        returns_a_text,
        raises,
        is_async,
        awaits_what_was_cancelled,
        is_async_and_returns_nothing,
    )
    return next(each for each in known if each.__name__ == fault)


WRONG = ("returns_nothing", "returns_a_text", "is_async_and_returns_nothing")
ASYNC = ("is_async", "awaits_what_was_cancelled")
FAULTS = (*WRONG, "raises", *ASYNC)


def _succeed(goal: Any) -> Any:
    goal.succeed()
    return Fibonacci.Result(sequence=[1, 1, 2])


def _goal_of(scene: Scene, **callbacks: Any) -> Any:
    execute = callbacks.pop("execute_callback", _succeed)
    ActionServer(scene.node, Fibonacci, "count", execute, callback_group=scene.group, **callbacks)
    client = ActionClient(scene.client_node, Fibonacci, "count", callback_group=scene.group)
    scene.until(client.server_is_ready)
    return scene.answer(client.send_goal_async(Fibonacci.Goal(order=3)))


@pytest.mark.filterwarnings("ignore:the future that is awaited was cancelled")
@pytest.mark.parametrize("has_succeeded", [False, True])
@pytest.mark.parametrize("fault", FAULTS)
def test_execute(scene: Scene, fault: str, has_succeeded: bool) -> None:
    callback = _faulty(fault, _succeed)
    if has_succeeded and fault in WRONG:

        def execute(goal: Any) -> Any:
            goal.succeed()
            return None if "nothing" in fault else "text"

        callback = execute
    goal = _goal_of(scene, execute_callback=callback)
    response = scene.answer(goal.get_result_async())
    assert response.status == (SUCCESS if fault in ASYNC else ABORTED)
    assert list(response.result.sequence) == ([1, 1, 2] if fault in ASYNC else [])
    if fault in WRONG:
        given = "None" if "nothing" in fault else "str"
        assert (
            f"execute callback of action 'count' returned {given}, expected Fibonacci_Result" in scene.said()
        )
    assert not scene.raised


@pytest.mark.filterwarnings("ignore:the future that is awaited was cancelled")
@pytest.mark.parametrize("fault", FAULTS)
def test_goal(scene: Scene, fault: str) -> None:
    goal = _goal_of(scene, goal_callback=_faulty(fault, lambda _: GoalResponse.ACCEPT))
    assert goal.accepted == (fault in ASYNC)
    if fault == "raises":
        scene.until(lambda: scene.raised)
    assert bool(scene.raised) == (fault == "raises")
    assert (fault in WRONG) == ("Goal request callback did not return a GoalResponse" in scene.said())


@pytest.mark.parametrize("fault", ["raises", "is_async"])
def test_handle_accepted(scene: Scene, fault: str) -> None:
    goal = _goal_of(scene, handle_accepted_callback=_faulty(fault, lambda goal: goal.execute()))
    response = scene.answer(goal.get_result_async())
    assert response.status == (ABORTED if fault == "raises" else SUCCESS)
    assert [type(error) for error in scene.raised] == ([Boom] if fault == "raises" else [])


@pytest.mark.filterwarnings("ignore:the future that is awaited was cancelled")
@pytest.mark.parametrize("fault", FAULTS)
def test_cancel(scene: Scene, fault: str) -> None:
    goal = _goal_of(
        scene,
        handle_accepted_callback=lambda _: None,
        cancel_callback=_faulty(fault, lambda _: CancelResponse.ACCEPT),
    )
    response = scene.answer(goal.cancel_goal_async())
    assert len(response.goals_canceling) == (fault in ASYNC)
    if fault == "raises":
        scene.until(lambda: scene.raised)
    assert (fault in WRONG) == ("cancel callback of action 'count' returned" in scene.said())


def test_an_action_server_that_destroys_itself(scene: Scene) -> None:
    servers: list[ActionServer] = []

    def execute(goal: Any) -> Any:
        servers[0].destroy()
        return _succeed(goal)

    servers.append(ActionServer(scene.node, Fibonacci, "count_once", execute, callback_group=scene.group))
    client = ActionClient(scene.client_node, Fibonacci, "count_once", callback_group=scene.group)
    scene.until(client.server_is_ready)
    goal = scene.answer(client.send_goal_async(Fibonacci.Goal()))
    scene.until(lambda: "was destroyed while it executed a goal" in scene.said())
    assert isinstance(scene.answer(goal.get_result_async()), ServerGoneError)
    assert isinstance(scene.answer(goal.cancel_goal_async()), ServerGoneError)


@pytest.mark.filterwarnings("ignore:the future that is awaited was cancelled")
@pytest.mark.parametrize("fault", [*FAULTS, "destroys"])
def test_service(scene: Scene, fault: str) -> None:
    def destroys(_: Any, response: Any) -> Any:
        scene.node.destroy_service(service)
        return response

    callback = destroys if fault == "destroys" else _faulty(fault, lambda _, response: response)
    service = scene.node.create_service(Trigger, "switch", callback, callback_group=scene.group)
    client = scene.client_node.create_client(Trigger, "switch", callback_group=scene.group)
    answer = scene.answer(client.call_async(Trigger.Request()))
    if fault in ASYNC:
        assert isinstance(answer, Trigger.Response)
    else:
        assert isinstance(answer, ServerGoneError)
        if fault == "destroys":
            scene.until(lambda: "service '/switch' was destroyed during a request" in scene.said())
        else:
            scene.until(lambda: scene.raised)
        if fault in WRONG:
            assert str(scene.raised[0]).startswith("expected Trigger_Response, got ")


def test_another_server_may_still_answer_what_one_does_not(scene: Scene) -> None:
    def answer(_: Any, response: Any) -> Any:
        return Trigger.Response(message="here")

    scene.node.create_service(Trigger, "switch", _faulty("raises", answer), callback_group=scene.group)
    scene.client_node.create_service(Trigger, "switch", answer, callback_group=scene.group)
    client = scene.client_node.create_client(Trigger, "switch", callback_group=scene.group)
    assert scene.answer(client.call_async(Trigger.Request())).message == "here"


def _timer(scene: Scene, callback: Any) -> None:
    scene.node.create_timer(0.001, callback, callback_group=scene.group)


def _subscription(scene: Scene, callback: Any) -> None:
    scene.node.create_subscription(String, "word", callback, 1, callback_group=scene.group)
    scene.client_node.create_publisher(String, "word", 1).publish(String())


def _guard(scene: Scene, callback: Any) -> None:
    scene.node.create_guard_condition(callback, callback_group=scene.group).trigger()


def _event(scene: Scene, callback: Any) -> None:
    events = SubscriptionEventCallbacks(matched=callback)
    scene.node.create_subscription(
        String, "word", print, 1, event_callbacks=events, callback_group=scene.group
    )
    scene.client_node.create_publisher(String, "word", 1)


def _done(scene: Scene, callback: Any) -> None:
    future = scene.executor.create_future()
    future.add_done_callback(callback)
    future.set_result(None)


def _task(scene: Scene, callback: Any) -> None:
    scene.executor.create_task(callback)


@pytest.mark.parametrize("begin", [_timer, _subscription, _guard, _event, _done, _task])
def test_what_a_callback_raises_comes_out_of_the_next_spin(scene: Scene, begin: Any) -> None:
    begin(scene, _faulty("raises", print))
    scene.until(lambda: scene.raised)
    assert type(scene.raised[0]) is Boom


@pytest.mark.parametrize("begin", [_timer, _subscription, _guard, _event, _done, _task])
def test_a_callback_that_looks_for_asyncio_is_told_what_to_do(scene: Scene, begin: Any) -> None:
    import asyncio

    async def nap(*_: Any) -> None:
        await asyncio.sleep(0.1)

    begin(scene, nap)
    scene.until(lambda: scene.raised)
    assert "no running event loop: an executor of rclpy runs this callback" in str(scene.raised[0])
    assert "sleep" not in str(scene.raised[0].__cause__)


@pytest.mark.parametrize("begin", [_timer, _subscription, _guard, _event, _done, _task])
def test_await_of_a_cancelled_future_is_said(scene: Scene, begin: Any) -> None:
    begin(scene, _faulty("awaits_what_was_cancelled", lambda *_: None))
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always")
        scene.until(lambda: said)
    assert "ask `future.cancelled()`" in str(said[0].message)


@pytest.mark.parametrize("begin", [_timer, _subscription, _guard])
def test_a_generator_function_is_said_to_run_nothing(scene: Scene, begin: Any) -> None:
    def waits(*_: Any) -> Iterator[None]:
        yield

    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always")
        begin(scene, waits)
        scene.until(lambda: said)
    assert "nothing runs the generator function" in str(said[0].message)


STEPS = {
    "on_configure": (10, ["configure"], "unconfigured", "inactive"),
    "on_activate": (13, ["configure", "activate"], "unconfigured", "active"),
    "on_deactivate": (14, ["configure", "activate", "deactivate"], "unconfigured", "inactive"),
    "on_cleanup": (11, ["configure", "cleanup"], "unconfigured", "unconfigured"),
    "on_shutdown": (12, ["shutdown"], "unconfigured", "finalized"),
}


@pytest.mark.parametrize("fault", ["returns_nothing", "returns_a_text", "raises", "is_async"])
@pytest.mark.parametrize("name", [*STEPS, "on_error"])
def test_transitions(name: str, fault: str, capfd: pytest.CaptureFixture[str]) -> None:
    rclpy.init()
    node = LifecycleNode("motor")
    faulty = _faulty(fault, lambda _: TransitionCallbackReturn.SUCCESS)
    if name == "on_error":
        node._callbacks[10] = lambda _: TransitionCallbackReturn.ERROR
        node._callbacks[15] = faulty
        steps, state = ["configure"], "finalized"
    else:
        number, steps, state, _ = STEPS[name]
        node._callbacks[number] = faulty
    answers = [getattr(node, f"trigger_{step}")() for step in steps]
    assert answers[-1] == TransitionCallbackReturn.ERROR
    assert node._state_machine.current_state[1] == state
    said = capfd.readouterr().err
    assert said.count("[ERROR]") == 1
    assert ("raised Boom" if fault == "raises" else "expected TransitionCallbackReturnType") in said
    rclpy.shutdown()


@pytest.mark.filterwarnings("ignore:Callback returned an invalid type")
@pytest.mark.parametrize("fault", [*WRONG, "raises"])
def test_on_set(scene: Scene, fault: str) -> None:
    node = scene.node
    node.declare_parameter("gain", 0.1)
    node.add_on_set_parameters_callback(_faulty(fault, lambda _: SetParametersResult(successful=True)))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # nobody awaits the callback
        if fault == "raises":
            with pytest.raises(Boom):
                node.set_parameters([Parameter("gain", value=0.2)])
        else:
            (result,) = node.set_parameters([Parameter("gain", value=0.2)])
            assert not result.successful
            assert result.reason == "Callback returned an invalid type"
    assert node.get_parameter("gain").value == 0.1


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
@pytest.mark.parametrize("executor", ["rclpy", SingleThreadedExecutor, MultiThreadedExecutor])
def test_callbacks_at_shutdown_are_called_once_after_a_signal(executor: Any, number: signal.Signals) -> None:
    rclpy.init()
    node, calls = rclpy.create_node("motor"), []
    node.context.on_shutdown(lambda: calls.append(threading.current_thread()))
    node.create_timer(0.001, lambda: os.kill(os.getpid(), number))
    try:
        if executor == "rclpy":
            rclpy.spin(node)
        else:
            made = executor(*((2,) if executor is MultiThreadedExecutor else ()))
            made.add_node(node)
            made.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    assert calls == [threading.main_thread()]
    rclpy.try_shutdown()
    assert len(calls) == 1


def test_who_does_not_spin_calls_back_when_it_shuts_down() -> None:
    rclpy.init()
    calls: list[str] = []
    rclpy.get_default_context().on_shutdown(lambda: calls.append("once"))
    os.kill(os.getpid(), signal.SIGTERM)
    assert not rclpy.ok()
    assert not calls
    rclpy.try_shutdown()
    assert calls == ["once"]


def test_a_callback_at_shutdown_that_raises_keeps_no_other_from_its_call() -> None:
    rclpy.init()
    calls: list[str] = []
    context = rclpy.get_default_context()
    context.on_shutdown(_faulty("raises", print))
    context.on_shutdown(lambda: calls.append("second"))
    with pytest.raises(Boom):
        rclpy.shutdown()
    assert calls == ["second"]


@pytest.mark.parametrize("fault", ["returns_nothing", "is_async"])
def test_pre_set(scene: Scene, fault: str) -> None:
    node = scene.node
    node.declare_parameter("gain", 0.1)
    node.add_pre_set_parameters_callback(_faulty(fault, lambda parameters: parameters))
    with pytest.raises(TypeError, match=r"a pre-set callback of parameters returned .*, expected list"):
        node.set_parameters([Parameter("gain", value=0.2)])
    assert node.get_parameter("gain").value == 0.1
