"""A program on DDS with a bridge to Zenoh, as one: what it is told is also arranged with the bridge."""

from __future__ import annotations

from typing import Any, Final

from tests.interop.bench import samples
from tests.interop.bench.exchange import Actor

_PARAMETER_SERVICES: Final = (
    ("get_parameters", samples.GET_PARAMETERS),
    ("set_parameters", samples.SET_PARAMETERS),
)


class Bridged:
    """An actor whose topics, services and actions are passed on."""

    def __init__(self, actor: Actor, bridge: Actor) -> None:
        self.node = actor.node
        self.versions = actor.versions | bridge.versions
        self._actor, self._bridge = actor, bridge
        self._forwarded: set[str] = set()

    def do(self, command: str, **arguments: Any) -> Any:
        """Do something. Raises Failed and Lacking."""
        match command:
            case "publish" | "subscribe":
                self._bridge.do("forward", **arguments, to_zenoh=command == "publish")
                return self._actor.do(command, **arguments)
            case "serve" | "serve_action":
                self._actor.do(command, **arguments)
                kind = "service" if command == "serve" else "action"
                self._forward(kind, arguments[kind], arguments["type"], to_zenoh=False)
                return None
            case "declare":
                self._actor.do(command, **arguments)
                for name, type_name in _PARAMETER_SERVICES:
                    self._forward("service", f"/{self.node}/{name}", type_name, to_zenoh=False)
                return None
            case "call" | "act":
                kind = "service" if command == "call" else "action"
                self._forward(kind, arguments[kind], arguments["type"], to_zenoh=True)
                return self._actor.do(command, **arguments)
            case _:
                return self._actor.do(command, **arguments)

    def close(self) -> None:
        """End both."""
        self._actor.close()
        self._bridge.close()

    def _forward(self, kind: str, name: str, type_name: str, *, to_zenoh: bool) -> None:
        """Let the bridge pass on a service or an action, once."""
        if name not in self._forwarded:
            self._forwarded.add(name)
            self._bridge.do(f"forward_{kind}", **{kind: name}, type=type_name, to_zenoh=to_zenoh)
