"""Access control of Zenoh, with a router and sessions: what is granted passes, and nothing else does."""

from __future__ import annotations

import json
import random
import socket
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from ifgen.nodl.model import Category
from ifgen_tools.policy import zenoh as form
from ifgen_tools.policy.grants import Grant, Grants

from .conftest import DOMAIN

zenoh = pytest.importorskip("zenoh")

PATIENCE = 10.0
NO_HASH = "TypeHashNotSupported"
KINDS = {
    Category.PUBLISHER: Category.SUBSCRIPTION,
    Category.SERVICE_SERVER: Category.SERVICE_CLIENT,
}
OPPOSITE = {**KINDS, **{value: key for key, value in KINDS.items()}}


def until(condition: Callable[[], object]) -> bool:
    end = time.monotonic() + PATIENCE
    while time.monotonic() < end:
        if condition():
            return True
        time.sleep(0.01)  # Zenoh's threads have no other way to say it
    return False


class Site:
    """A router with its rules, and a session for each node, which shows who it is by a user's name."""

    def __init__(self, folder: Path, robot: list[Grants], *, in_sessions: bool = False) -> None:
        self.robot = {each.node: each for each in robot}
        self.is_in_sessions = in_sessions
        self._tokens: list[Any] = []
        with socket.create_server(("127.0.0.1", 0)) as server:
            self.endpoint = f"tcp/127.0.0.1:{server.getsockname()[1]}"
        users = folder / "users"
        users.write_text("".join(f"{name}:secret\n" for name in (*self.robot, "/stranger")))
        router = {"mode": "router"} if in_sessions else form.router(robot, DOMAIN, "users")
        self.router = zenoh.open(
            config(
                router,
                {
                    "listen/endpoints": [self.endpoint],
                    "transport/auth/usrpwd": {"dictionary_file": str(users)},
                    "scouting/multicast/enabled": False,
                },
            )
        )
        of_sessions = form.sessions(robot, DOMAIN) if in_sessions else {}
        self.sessions = {
            name: zenoh.open(
                config(
                    of_sessions.get(name, {}),
                    {
                        "mode": "client",
                        "connect/endpoints": [self.endpoint],
                        "transport/auth/usrpwd": {"user": name, "password": "secret"},
                        "timestamping/enabled": True,
                    },
                )
            )
            for name in (*self.robot, "/stranger")
        }

    def close(self) -> None:
        for session in (*self.sessions.values(), self.router):
            session.close()

    def parts(self, category: Category) -> Iterator[tuple[str, Grant]]:
        for name, node in self.robot.items():
            yield from ((name, part) for part in node.parts if part.category is category)

    def exchanges(self) -> Iterator[tuple[str, str, Grant]]:
        """Each pair of nodes that may exchange something: the source, the other one, and the source's end."""
        for source, opposite in KINDS.items():
            for one, part in self.parts(source):
                for other, end in self.parts(opposite):
                    if (end.name, end.type_name) == (part.name, part.type_name):
                        yield one, other, part

    def may(self, node: str, category: Category, name: str) -> bool:
        found = self.robot.get(node)
        return found is not None and any(p.category is category and p.name == name for p in found.parts)

    def key(self, part: Grant) -> str:
        return form.data_key(part, DOMAIN).replace("*", NO_HASH)

    def token(self, node: str) -> str:
        """Declare the token of a node, for itself."""
        return self._declare(node, node)

    def fake_token(self, node: str, by: str) -> str:
        """Declare the token of a node for another one."""
        return self._declare(node, by)

    def _declare(self, node: str, by: str) -> str:
        namespace, _, name = node.rpartition("/")
        session = self.sessions[by]
        token = f"@ros2_lv/{DOMAIN}/{session.zid()}/0/0/NN/%/{namespace.replace('/', '%') or '%'}/{name}"
        self._tokens.append(session.liveliness().declare_token(token))
        return token

    def passes(self, one: str, other: str, part: Grant) -> bool:
        """Whether something gets from a publisher to a subscription, or to a server and back."""
        key = self.key(part)
        source, sink = self.sessions[one], self.sessions[other]
        got: list[Any] = []
        if part.category is Category.PUBLISHER:
            subscriber = sink.declare_subscriber(key, got.append)
            publisher = source.declare_publisher(key)
            done = until(lambda: publisher.put(b"x") or got)
            subscriber.undeclare()
            publisher.undeclare()
            return done
        queryable = source.declare_queryable(key, lambda query: query.reply(key, one.encode()))
        done = until(lambda: [reply for reply in sink.get(key, timeout=0.2) if reply.ok is not None])
        queryable.undeclare()
        return done


def config(*parts: dict[str, Any]) -> Any:
    made = zenoh.Config()
    for part in parts:
        for key, value in part.items():
            made.insert_json5(key, json.dumps(value))
    return made


@pytest.fixture(params=["router", "sessions", "humanoid"])
def site(request: pytest.FixtureRequest, tmp_path: Path, robot: list[Grants]) -> Iterator[Site]:
    """The small robot at a router with rules, and with sessions that have them; and the humanoid's crew."""
    system = request.getfixturevalue("humanoid") if request.param == "humanoid" else robot
    made = Site(tmp_path, system, in_sessions=request.param == "sessions")
    yield made
    made.close()


def test_the_robot_has_each_kind_of_endpoint(robot: list[Grants]) -> None:
    parts = {(part.category, part.name) for node in robot for part in node.parts}
    action = "/robot/move/_action"
    for name in ("send_goal", "get_result", "cancel_goal"):
        assert {
            (Category.SERVICE_SERVER, f"{action}/{name}"),
            (Category.SERVICE_CLIENT, f"{action}/{name}"),
        } < parts
    assert (Category.SUBSCRIPTION, f"{action}/feedback") in parts
    assert {(Category.PUBLISHER, "/robot/map"), (Category.SUBSCRIPTION, "/robot/map")} < parts
    assert {(Category.PUBLISHER, "/robot/cmd_vel"), (Category.SUBSCRIPTION, "/clock")} < parts
    assert {
        (Category.SERVICE_SERVER, "/robot/camera/change_state"),
        (Category.SERVICE_SERVER, "/robot/driver/get_type_description"),
    } < parts


@pytest.mark.slow
def test_every_exchange_passes(site: Site) -> None:
    exchanges = list(site.exchanges())
    assert len(exchanges) >= 9
    assert [each for each in exchanges if not site.passes(*each)] == []


@pytest.mark.slow
def test_nothing_else_passes(site: Site) -> None:
    """Whoever has no right to an end of an exchange gets nothing through: over a hundred trials."""
    trials: list[Trial] = []
    for one, other, part in site.exchanges():
        for node in site.sessions:
            if node == "/stranger" and site.is_in_sessions:
                continue  # nobody holds it back
            for category in (part.category, OPPOSITE[part.category]):
                # Within a session there is no link that anybody could guard.
                if node not in {one, other} and not site.may(node, category, part.name):
                    trials.append(Trial(site, node, category, one, other, part))
        # The rightful ones, but with another type, or with another definition of it.
        for wrong in (replace(part, type_name="std_msgs/msg/Int8"), replace(part, type_hash="RIHS01_0")):
            trials.append(Trial(site, one, part.category, one, other, wrong))
            trials.append(Trial(site, other, OPPOSITE[part.category], one, other, wrong))
    trials = random.Random(28).sample(trials, min(len(trials), 150))
    for trial in trials:
        trial.begin()
    # What is right passes afterwards, on the same ways.
    assert all(site.passes(*exchange) for exchange in site.exchanges())
    assert [what for trial in trials if (what := trial.end())] == []
    first, *others, last = site.robot
    fake = [site.fake_token(last, by) for by in others]
    right = site.token(last)
    observer = site.sessions[first].liveliness()

    def seen() -> set[str]:
        replies = observer.get(f"@ros2_lv/{DOMAIN}/**", timeout=1.0)
        return {str(reply.ok.key_expr) for reply in replies if reply.ok is not None}

    assert until(lambda: right in seen())
    assert seen().isdisjoint(fake)
    assert len(trials) + len(fake) >= (90 if site.is_in_sessions else 100)


class Trial:
    """An end of an exchange that a node tries to have, and what it got or others got of it."""

    def __init__(self, site: Site, node: str, category: Category, one: str, other: str, part: Grant) -> None:
        self._key = site.key(part)
        self.what = f"{node} as {category.singular} of {self._key}"
        self._category = category
        self._own, self._source, self._sink = (site.sessions[name] for name in (node, one, other))
        self._got: list[Any] = []
        self._declared: list[Any] = []

    def begin(self) -> None:
        key, mark = self._key, self.what.encode()
        match self._category:
            case Category.PUBLISHER:
                self._declared.append(self._heard_by(self._sink))
                self._own.put(key, mark)
            case Category.SUBSCRIPTION:
                self._declared.append(self._heard_by(self._own))
                self._source.put(key, mark)
            case Category.SERVICE_SERVER:
                self._declared.append(
                    self._own.declare_queryable(
                        key, lambda query: query.reply(key, mark), allowed_origin=zenoh.Locality.REMOTE
                    )
                )
            case _:
                queryable = self._source.declare_queryable(key, lambda query: query.reply(key, mark))
                self._got += [r for r in self._own.get(key, timeout=0.1) if r.ok is not None]
                queryable.undeclare()

    def _heard_by(self, session: Any) -> Any:
        remote = zenoh.Locality.REMOTE  # what it sends itself does not count
        return session.declare_subscriber(self._key, self._got.append, allowed_origin=remote)

    def end(self) -> str:
        """What came through; empty if nothing did."""
        if self._category is Category.SERVICE_SERVER:
            answers = self._sink.get(self._key, timeout=0.1)
            self._got += [r for r in answers if r.ok and r.ok.payload.to_bytes() == self.what.encode()]
        got = self._got
        if self._category is Category.PUBLISHER:  # the rightful publisher's come, too
            got = [each for each in got if each.payload.to_bytes() == self.what.encode()]
        for each in self._declared:
            each.undeclare()
        return f"{self.what}: {got}" if got else ""


def test_keys_are_those_of_rmw_zenoh(robot: list[Grants]) -> None:
    keys = {form.data_key(part, 0).rpartition("/")[0]: part for node in robot for part in node.parts}
    scan = keys["0/robot/scan/std_msgs::msg::dds_::Float64_"]
    assert scan.type_hash == "RIHS01_705ba9c3d1a09df43737eb67095534de36fd426c0587779bda2bc51fe790182a"
    assert keys["0/robot/move/_action/send_goal/example_interfaces::action::dds_::Fibonacci_SendGoal_"]


def test_one_identity_for_several_nodes(robot: list[Grants]) -> None:
    """Nodes of one enclave share their rights, as those of a container do."""
    together = [replace(each, enclave="/robot") for each in robot]
    control = form.router(together, DOMAIN, "certificates")["access_control"]
    assert control["subjects"] == [{"id": "/robot", "cert_common_names": ["/robot"]}]
    assert control["default_permission"] == "deny"
    assert form.sessions(together, DOMAIN).keys() == {"/robot"}
