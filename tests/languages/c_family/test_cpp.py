"""The generator of C++: its headers compile, differ from rosidl's where the page says so, and pass the suite."""

from __future__ import annotations

from pathlib import Path

import pytest
from ifgen.model import Model
from ifgen_generators.cpp import GENERATOR

from ...conformance.support import tool
from .support import ROOT, WARNINGS, corpus, generate, load, run, write

STRICT = [*WARNINGS, "-fsyntax-only"]
MISUSE = """\
#include <cstdio>
#include "sensor_msgs/msg/joint_state.hpp"
#include "std_srvs/srv/set_bool.hpp"
int main()
{
  sensor_msgs::msg::JointState m, other;
  m.name = {"a", std::string("b\\0c", 3)};
  std::vector<std::uint8_t> bytes;
  std::printf("%s\\n", ifgen::encode(m, bytes).text().c_str());
  m.name[1] = "b";
  m.position = {1.0};
  static_cast<void>(ifgen::encode(m, bytes));
  std::size_t written = 0;
  std::printf("%s\\n", ifgen::encode_into(m, bytes.data(), bytes.size() - 1, written).text().c_str());
  std::printf("%s\\n", ifgen::decode(bytes.data(), bytes.size() - 5, other).text().c_str());
  bytes[20] = 0xff;
  bytes[23] = 0xff;
  std::printf("%s\\n", ifgen::decode(bytes, other).text().c_str());
  bytes[1] = 3;
  std::printf("%s\\n", ifgen::decode(bytes, other).text().c_str());
  std::printf("%s\\n", ifgen::type_name<std_srvs::srv::SetBool>);
}
"""


def test_a_failure_names_the_field(tmp_path: Path) -> None:
    model = load(ROOT / "interfaces/sensor_msgs/msg/JointState.msg", ROOT / "interfaces/std_srvs")
    write(generate(GENERATOR, model), tmp_path)
    (tmp_path / "main.cpp").write_text(MISUSE)
    run([tool("g++"), "-std=c++17", *WARNINGS, f"-I{tmp_path}", "main.cpp", "-o", "main"], tmp_path)
    assert run([str(tmp_path / "main")]).splitlines() == [
        "name[1]: a string ends at its NUL on the wire",
        "the message needs more room",
        "velocity: the payload ends before the message",
        "name: a sequence is longer than what is left of the payload",
        "expected plain CDR: a header 0000 or 0001",
        "std_srvs/srv/SetBool",
    ]


def test_reserved_words_and_macros_are_no_problem(tmp_path: Path) -> None:
    path = tmp_path / "a_msgs/msg/Thing.msg"
    path.parent.mkdir(parents=True)
    path.write_text("uint8 ERROR=1\nuint8 class\nfloat32 operator\nstring template\n")
    write(generate(GENERATOR, load(tmp_path / "a_msgs")), tmp_path)
    source = tmp_path / "main.cpp"
    source.write_text(
        '#define ERROR 0\n#include "a_msgs/msg/thing.hpp"\n'
        'static_assert(ERROR == 0, "the macro is back");\n'
        'int main() {a_msgs::msg::Thing t; t.class_ = 1; t.operator_ = 2; t.template_ = ""; return t.class_ - 1;}\n'
    )
    run([tool("g++"), "-std=c++17", *STRICT, f"-I{tmp_path}", str(source)])


@pytest.fixture(scope="module")
def everything() -> Model:
    return load(ROOT / "interfaces", ROOT / "tests/conformance/interfaces")


@pytest.mark.slow
@pytest.mark.parametrize("compiler", ["g++", "clang++"])
@pytest.mark.parametrize("standard", ["c++17", "c++20"])
def test_all_headers_compile(everything: Model, tmp_path: Path, compiler: str, standard: str) -> None:
    tool(compiler)
    write(generate(GENERATOR, corpus(tmp_path / "corpus")), tmp_path)
    write(generate(GENERATOR, everything), tmp_path)
    headers = sorted(path.relative_to(tmp_path) for path in tmp_path.rglob("*.hpp"))
    source = tmp_path / "all.cpp"
    source.write_text("".join(f'#include "{header}"\n' for header in headers))
    run([compiler, f"-std={standard}", *STRICT, f"-I{tmp_path}", str(source)])


@pytest.mark.slow
def test_the_headers_of_rosidl_beside_ours_are_an_error(tmp_path: Path) -> None:
    rosidl = ROOT / ".venv/include/std_msgs"
    if not rosidl.is_dir():
        pytest.skip("the headers of ROS are not installed")
    write(generate(GENERATOR, load(ROOT / "interfaces/std_msgs/msg/Bool.msg")), tmp_path)
    source = tmp_path / "main.cpp"
    source.write_text('#define STD_MSGS__MSG__DETAIL__BOOL__STRUCT_HPP_\n#include "std_msgs/msg/bool.hpp"\n')
    with pytest.raises(AssertionError, match="of rosidl and of ifgen cannot be in one program"):
        run([tool("g++"), "-std=c++17", "-fsyntax-only", f"-I{tmp_path}", str(source)])
