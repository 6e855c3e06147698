"""What holds in all languages: the suite, random messages, hostile bytes, and names that meet."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from random import Random

import pytest
from ifgen.pipeline.stages import load as load_registry
from ifgen_runtime import serialize
from ifgen_tools.conformance import testee as protocol
from ifgen_tools.conformance.cases import MEMORY
from ifgen_tools.conformance.random_messages import Comparison, compare, message_classes, random_message

from ..codec.fuzzing.payloads import mutated
from ..conformance.support import run_suite
from .c_family.support import load
from .support import ALL, write_traps
from .testees import build_testee, command_of

LANGUAGES = ("c", "cpp", "rust", "typescript")
MESSAGES = 50  # random ones of each type; `ifgen conformance --random 1000` is for a release
MUTATIONS = 40  # of each type


@pytest.fixture(params=LANGUAGES)
def command(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> list[str]:
    """A testee with all types: C and C++ with sanitizers, Rust with checks of overflow."""
    return command_of(request.param, tmp_path_factory)


@pytest.mark.slow
@pytest.mark.timeout(900)  # minutes of compiling, for whichever test comes first
def test_the_suite_passes(command: list[str]) -> None:
    code, text = run_suite(command)
    assert code == 0, text


@pytest.mark.slow
@pytest.mark.timeout(900)  # minutes of compiling, as above
def test_random_messages_have_the_same_bytes_and_values(command: list[str]) -> None:
    code, text = run_suite(command, "--random", str(MESSAGES))
    assert code == 0, text
    assert text.endswith(" types: 0 differ in bytes, 0 in values\n")


@pytest.mark.slow
@pytest.mark.timeout(900)  # minutes of compiling, as above
def test_mutated_bytes_are_read_or_refused(command: list[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ASAN_OPTIONS", "quarantine_size_mb=8")  # what is freed does not count
    program = protocol.Testee(command, 20)
    try:
        program.hello()
        before = program.peak
        wrong = list(_wrong(program))
        memory = program.peak - before
    finally:
        program.close()
    assert wrong == []
    assert memory < MEMORY


def _wrong(program: protocol.Testee) -> Iterator[str]:
    """Replies that are neither a payload nor a refusal, and payloads that are read as others than they are."""
    for name, cls in message_classes(load_registry(*ALL)):
        rng = Random(f"hostile {name}")
        good = [bytes(serialize(random_message(rng, cls))) for _ in range(8)]
        broken = [mutated(rng, rng.choice(good), rng.choice(good)).hex() or "-" for _ in range(MUTATIONS)]
        replies = program.ask_all([protocol.Request("recode", name, (data,)) for data in broken])
        read = [reply.data for reply in replies if reply.verdict == "ok"]
        again = program.ask_all([protocol.Request("recode", name, (data,)) for data in read])
        for data, reply in zip(broken, replies, strict=True):
            if reply.verdict not in ("ok", "refused"):
                yield f"{name} {data}: {reply.text}"
        for data, reply in zip(read, again, strict=True):
            if reply.text != f"ok {data}":
                yield f"{name} {data}: {reply.text}"


@pytest.mark.slow
@pytest.mark.parametrize("language", LANGUAGES)
def test_every_trap_has_the_bytes_and_hashes_of_our_classes(tmp_path: Path, language: str) -> None:
    traps = write_traps(tmp_path / "traps")
    paths = traps / "trap_msgs", traps / "other_msgs"
    model = load(*paths)
    hashes = {message.type_name: message.type_hash for message in model.types}
    for package in model.packages:
        for interface in package.interfaces:
            hashes[interface.type_name] = interface.type_hash
            hashes |= {service.type_name: service.type_hash for service in interface.services}
    program = protocol.Testee(build_testee(language, tmp_path, *paths), 20)
    result = Comparison()
    try:
        names = [name for name in sorted(hashes) if name.startswith(("trap_msgs/", "other_msgs/"))]
        replies = program.ask_all([protocol.Request("hash", name) for name in names])
        wrong = list(
            compare(program, load_registry(*paths, include=ALL[:1]), 10, ("random/*_msgs/*",), result)
        )
    finally:
        program.close()
    assert {name: reply.data for name, reply in zip(names, replies, strict=True)} == {
        name: hashes[name] for name in names
    }
    assert wrong == []
    assert result.types > 50
