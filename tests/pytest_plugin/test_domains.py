"""Tests get a ROS domain that nobody else uses and on which nothing hangs."""

from __future__ import annotations

from pathlib import Path

import pytest
from ifgen_pytest import domains


def test_two_tests_at_once_have_two_domains() -> None:
    with domains.own_domain() as one, domains.own_domain() as other:
        assert one != other
        assert {one, other} <= set(range(1, 102))


def test_a_domain_is_passed_over_where_a_killed_process_left_an_empty_port(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(domains, "_SHARED_MEMORY", tmp_path)
    monkeypatch.setattr(domains, "_numbers", iter(range(40, 60)))  # domain 41 comes first
    (tmp_path / "fastrtps_port17661").touch()  # 7400 + 250 * 41 + 11: its first participant's port for data
    (tmp_path / "fastrtps_port17911").write_bytes(b"a port that is in use")
    with domains.own_domain() as domain:
        assert 41 < domain <= 60  # the next that no other test has


def test_there_are_no_more_domains(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(domains, "_hangs", lambda _: True)
    says = "all 101 ROS domains are in use by other tests on this machine"
    with pytest.raises(RuntimeError, match=says), domains.own_domain():
        pytest.fail("there is none")
