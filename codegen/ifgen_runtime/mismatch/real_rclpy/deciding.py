"""The policy of a node, applied: it can adapt only where somebody has registered an adapter."""

from __future__ import annotations

from collections.abc import Iterable

from ifgen_runtime.adapters import adapter_for
from ifgen_runtime.mismatch.policy import OnTypeMismatch
from ifgen_runtime.mismatch.real_rclpy.endpoints import Part


def can_adapt(part: Part, type_hash: str) -> bool:
    """Whether an adapter converts what goes over a part, in its direction."""
    if type_hash == part.type_hash:
        return True
    adapter = adapter_for(type_hash, part.cls)
    return adapter is not None and (not part.written or adapter.downgrade is not None)


def applied(policy: OnTypeMismatch, role: str, parts: Iterable[tuple[Part, str]]) -> OnTypeMismatch:
    """The policy for an endpoint that meets somebody, whose hashes of some parts are these.

    A publisher sends whatever others do. Actions are not adapted.
    """
    if role == "publisher":
        return OnTypeMismatch.WARN
    if role.startswith("action"):
        return policy if policy is OnTypeMismatch.WARN else OnTypeMismatch.REFUSE
    if policy is OnTypeMismatch.ADAPT and not all(can_adapt(part, type_hash) for part, type_hash in parts):
        return OnTypeMismatch.REFUSE
    return policy
