"""For any input, the only exception is InputError, and every place that it names exists."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from ifgen.definition import build
from ifgen.definition.problems import FileProblems
from ifgen.definition.resolve import resolve
from ifgen.diagnostics import Diagnostic, InputError, Source
from ifgen.reading.packages import InterfaceFile, find_packages
from ifgen.reading.search_path import SearchPath

kinds = st.sampled_from(["msg", "srv", "action"])
words = r"""uint8 string<=3 Pose std_msgs/Header float32[3] a NAME = [ ] <= 1 " ' \ # --- é nan , \x \N{ /"""
ignore = ["# ifgen: ignore[keyword-name, é]", "ifgen:ignore", "//ifgen: ignore[", "class"]
pieces = st.sampled_from(
    [*words.split(), *ignore, " ", "  ", "\n", "\r\n", "\n---\n", "\t", "\ufeff", "\u2028", "\0"]
)
texts = st.one_of(st.text(max_size=200), st.lists(pieces, max_size=40).map("".join))
fuzzed = settings(max_examples=600)


def _check_places(diagnostics: list[Diagnostic]) -> None:
    for diagnostic in diagnostics:
        for label in (diagnostic.primary, *diagnostic.secondary):
            if label is not None:
                span = label.span
                assert 0 <= span.start <= span.end <= len(span.source.text)
                assert span.line >= 1 and span.column >= 1
        assert "\n" not in diagnostic.message


@fuzzed
@given(kind=kinds, text=texts)
def test_any_text(kind: str, text: str) -> None:
    """Any text becomes an interface or errors, with warnings only about places in the text."""
    source = Source(Path(f"Demo.{kind}"), text)
    problems = FileProblems(source)
    build.interface(source, "demo_msgs", kind, "Demo", problems)  # type: ignore[arg-type]
    _check_places([*problems.errors(), *problems.warnings()])


@fuzzed
@given(data=st.binary(max_size=60))
def test_any_bytes(data: bytes, tmp_path: Path) -> None:
    """Bytes are read as UTF-8 or refused at the first byte that is not UTF-8."""
    path = tmp_path / "Demo.msg"
    path.write_bytes(data)
    try:
        text = InterfaceFile(path, "msg").read().text
    except InputError as error:
        (diagnostic,) = error.diagnostics
        assert diagnostic.rule == "not-utf-8"
        _check_places([diagnostic])
        with pytest.raises(UnicodeDecodeError):
            data.decode()
    else:
        assert text.encode() == data.replace(b"\r\n", b"\n")


names = st.one_of(
    st.sampled_from(["A", "B", "Foo_Request", "bad", "None", "Sample_A", "é"]), st.text("Ab_1.", max_size=5)
)
trees = st.dictionaries(
    st.tuples(st.sampled_from(["msg", "srv", "action", "other", "."]), names, kinds),
    st.one_of(
        texts,
        st.sampled_from(["A a", "B b", "demo_msgs/A[] a", "---", "---\n---", "Missing m", "no_msgs/A a"]),
    ),
    max_size=5,
)


Tree = dict[tuple[str, str, str], str]
manifests = st.one_of(st.none(), st.binary(max_size=40))


@settings(fuzzed, max_examples=50)
@given(tree=trees, manifest=manifests)
def test_any_package(tree: Tree, manifest: bytes | None, tmp_path_factory: pytest.TempPathFactory) -> None:
    _read_package(tree, manifest, tmp_path_factory)


@pytest.mark.slow
@settings(fuzzed, max_examples=200)
@given(tree=trees, manifest=manifests)
def test_many_packages(tree: Tree, manifest: bytes | None, tmp_path_factory: pytest.TempPathFactory) -> None:
    _read_package(tree, manifest, tmp_path_factory)


def _read_package(tree: Tree, manifest: bytes | None, tmp_path_factory: pytest.TempPathFactory) -> None:
    """Any package folder becomes a registry or errors."""
    root = tmp_path_factory.mktemp("fuzz") / "demo_msgs"
    root.mkdir()
    for (folder, name, kind), text in tree.items():
        (root / folder).mkdir(exist_ok=True)
        (root / folder / f"{name}.{kind}").write_text(text, encoding="utf-8")
    if manifest is not None:
        (root / "package.xml").write_bytes(manifest)
    try:
        packages = find_packages([root])
        _check_places(list(resolve(packages, SearchPath(packages)).warnings))
    except InputError as error:
        _check_places(list(error.diagnostics))
