"""Where the policy of a node comes from."""

from __future__ import annotations

import pytest
from ifgen_runtime.mismatch.policy import OnTypeMismatch, policy_of


class Plain:
    pass


class Refusing:
    on_type_mismatch = "refuse"


def test_the_default_is_to_warn() -> None:
    assert policy_of(Plain()) is OnTypeMismatch.WARN


def test_the_parameter_comes_before_the_class_and_that_before_the_environment(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setenv("IFGEN_ON_TYPE_MISMATCH", "adapt")
    assert policy_of(Plain()) is OnTypeMismatch.ADAPT
    assert policy_of(Refusing()) is OnTypeMismatch.REFUSE
    assert policy_of(Refusing(), "warn") is OnTypeMismatch.WARN


def test_a_method_of_this_name_is_no_policy() -> None:
    class Calling:
        def on_type_mismatch(self) -> None: ...

    assert policy_of(Calling()) is OnTypeMismatch.WARN


def test_a_value_that_is_no_policy_says_where_it_is_and_what_was_expected(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    with pytest.raises(ValueError, match=r"^parameter on_type_mismatch is 'stop', expected one of warn, "):
        policy_of(Plain(), "stop")
    monkeypatch.setenv("IFGEN_ON_TYPE_MISMATCH", "Warn")
    with pytest.raises(ValueError, match=r"^IFGEN_ON_TYPE_MISMATCH is 'Warn', expected one of"):
        policy_of(Plain())
