"""Make the cases of the suite: `python -m tests.conformance.make_cases [FOLDER]`, for what is compiled.

Needs ROS 2 Jazzy's wheels and a C++ compiler. Real rosidl and Fast CDR write every payload: through rclpy for the
packages of the wheels, and through a C++ program for the others. Takes some minutes. The result is in `cases/`.
"""

from __future__ import annotations

import contextlib
import io
import json
import os
import random
import re
import struct
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterable, Iterator
from itertools import chain
from pathlib import Path
from typing import Any, Final

import ifgen
from ifgen_runtime import from_dict, serialize, to_dict
from ifgen_runtime.field_types import fields_of, message_class
from ifgen_tools.conformance.random_messages import fill, random_message

from tests.codec.big_endian import big_endian
from tests.codec.support import Classes, generate
from tests.conformance import definitions
from tests.conformance.testees.python import text_of

ROOT: Final = Path(__file__).resolve().parents[2]
CASES: Final = Path(__file__).with_name("cases")
SHARE: Final = Path(sys.prefix) / "share"
TUNABLES: Final = "glibc.malloc.tcache_count=0:glibc.malloc.perturb=255"  # makes padding 0
VISIBILITY: Final = (
    "rosidl_generator_c__visibility_control.h",
    "rosidl_generator_cpp__visibility_control.hpp",
    "rosidl_typesupport_fastrtps_cpp__visibility_control.h",
)

# -- what real rosidl and Fast CDR write


class Wheels:
    """The classes that the wheels bring."""

    def __init__(self) -> None:
        from rclpy.serialization import serialize_message

        self._serialize: Callable[[Any], bytes] = serialize_message

    def class_of(self, name: str) -> type[Any] | None:
        """The class of a type, or None."""
        package, folder, cls = name.split("/")
        if not (SHARE / package).is_dir():
            return None
        try:
            if cls.endswith("_FeedbackMessage"):
                return message_class(
                    f"{package}.{folder}", cls.removesuffix("_FeedbackMessage")
                ).Impl.FeedbackMessage  # type: ignore[no-any-return]
            return message_class(f"{package}.{folder}", cls)
        except (ImportError, AttributeError):
            return None

    def payload(self, cls: type[Any], message: Any) -> bytes:
        """The payload that rclpy writes, of a new message for None, with what it leaves uninitialised at its end."""
        return bytes(self._serialize(cls() if message is None else from_dict(cls, to_dict(message))))


class Compiled:
    """A C++ program that decodes payloads into rosidl's structures, and encodes them with Fast CDR."""

    def __init__(self, folder: Path, packages: Iterable[Path]) -> None:
        self._folder = folder
        self._packages = list(packages)
        self.hashes: dict[str, str] = {}
        for package in self._packages:
            if not (folder / "include" / package.name).is_dir():
                self._generate(package)
            self.hashes |= hashes_in(folder / "include" / package.name)

    def _generate(self, package: Path) -> None:
        from rosidl_adapter import convert_to_idl
        from rosidl_generator_c import generate_c
        from rosidl_generator_cpp import generate_cpp
        from rosidl_generator_type_description import generate_type_hash
        from rosidl_typesupport_fastrtps_cpp import generate_cpp as generate_support

        idl, output = self._folder / "idl" / package.name, self._folder / "include" / package.name
        tuples, hash_tuples = [], []
        for file in sorted(package.glob("*/*")):
            if file.suffix not in (".msg", ".srv", ".action", ".idl"):
                continue
            relative = file.relative_to(package)
            with contextlib.redirect_stdout(io.StringIO()):
                if file.suffix == ".idl":
                    (idl / relative).parent.mkdir(parents=True, exist_ok=True)
                    (idl / relative).write_bytes(file.read_bytes())
                else:
                    convert_to_idl(package, package.name, relative, idl)
            tuples.append(f"{idl}:{relative.with_suffix('.idl')}")
            hash_tuples.append(f"{relative.with_suffix('.idl')}:{output / relative.with_suffix('.json')}")
        own = (
            [f"{path.name}:{path}" for path in (self._folder / "include").iterdir()]
            if output.parent.is_dir()
            else []
        )
        include = [f"{path.name}:{path}" for path in SHARE.iterdir() if path.is_dir()] + own
        arguments = {
            "package_name": package.name,
            "output_dir": str(output),
            "idl_tuples": tuples,
            "include_paths": include,
            "type_description_tuples": hash_tuples,
            "ros_interface_dependencies": [],
            "target_dependencies": [],
            "additional_files": [],
        }
        file = self._folder / f"{package.name}.json"
        output.mkdir(parents=True)
        with contextlib.redirect_stdout(io.StringIO()):
            file.write_text(json.dumps(arguments))
            generate_type_hash(str(file))
            for name, generator in (
                ("rosidl_generator_c", generate_c),  # whose headers those of services include
                ("rosidl_generator_cpp", generate_cpp),
                ("rosidl_typesupport_fastrtps_cpp", generate_support),
            ):
                file.write_text(json.dumps({**arguments, "template_dir": str(SHARE / name / "resource")}))
                generator(str(file))
        (output / "msg").mkdir(exist_ok=True)
        for name in VISIBILITY:  # headers that CMake writes
            macros = (
                f"{name.partition('__')[0].upper()}_{word}_{package.name}" for word in ("PUBLIC", "EXPORT")
            )
            (output / "msg" / name).write_text(
                "#pragma once\n" + "".join(f"#define {macro}\n" for macro in macros)
            )

    def payloads(self, messages: Iterable[tuple[str, bytes]]) -> list[bytes]:
        """The payloads that Fast CDR writes after it read those given, by type; of a new message for no payload."""
        lines = "".join(f"{name} {payload.hex() or '-'}\n" for name, payload in messages)
        result = subprocess.run(
            [self._program()],
            input=lines,
            stdout=subprocess.PIPE,
            text=True,
            check=True,
            env={**os.environ, "LD_LIBRARY_PATH": f"{sys.prefix}/lib"},
        )
        return [bytes.fromhex(line) for line in result.stdout.split()]

    def _program(self) -> Path:
        program = self._folder / "recode"
        if program.exists():
            return program
        files = sorted((self._folder / "include").glob("*/*/detail/dds_fastrtps/*.cpp"))
        names = [
            (*file.relative_to(self._folder / "include").parts[:2], file.name.split("__")[0])
            for file in files
        ]
        types = sorted(name for name in self.types() if "/" in name)
        main = "".join(f'#include "{package}/{folder}/{name}.hpp"\n' for package, folder, name in names)
        main += "".join(
            f'#include "{package}/{folder}/detail/{name}__rosidl_typesupport_fastrtps_cpp.hpp"\n'
            for package, folder, name in names
        )
        main += PROGRAM.replace(
            "TYPES",
            "".join(
                f'{{"{name}", [](const B & b) {{ return recode<{name.replace("/", "::")}>(b, '
                f"[](auto & c, auto & m) {{ {support(name)}cdr_deserialize(c, m); }}, "
                f"[](auto & c, auto & m) {{ {support(name)}cdr_serialize(m, c); }}); }}}},\n"
                for name in types
            ),
        )
        source = self._folder / "recode.cpp"
        source.write_text(main)
        support_source = self._folder / "support.cpp"
        support_source.write_text("".join(f'#include "{file}"\n' for file in files))
        include = [
            f"-I{self._folder}/include",
            f"-I{sys.prefix}/include",
            *(f"-I{path}" for path in (Path(sys.prefix) / "include").iterdir()),
        ]
        libraries = [
            f"-l{path.name[3:-3]}"
            for path in (Path(sys.prefix) / "lib").glob("lib*__rosidl_typesupport_fastrtps_cpp.so")
        ]
        command = [
            "g++",
            "-std=c++17",
            "-O0",
            "-w",
            *include,
            str(source),
            str(support_source),
            "-o",
            str(program),
        ]
        command += [
            f"-L{sys.prefix}/lib",
            *libraries,
            "-lrosidl_typesupport_fastrtps_cpp",
            "-lrosidl_runtime_c",
        ]
        command += ["-lfastcdr", "-Wl,--unresolved-symbols=ignore-all"]
        subprocess.run(command, check=True, env={**os.environ, "LD_LIBRARY_PATH": f"{sys.prefix}/lib"})
        return program

    def types(self) -> Iterator[str]:
        """The names of the messages that were generated."""
        for path in (self._folder / "include").glob("*/*/detail/*__rosidl_typesupport_fastrtps_cpp.hpp"):
            for namespace, name in re.findall(r"const ([\w:]+)::(\w+) & ros_message,\n", path.read_text()):
                yield f"{namespace.strip(':').replace('::', '/')}/{name}"


def support(name: str) -> str:
    """The namespace of the functions of a type."""
    package, folder, _ = name.split("/")
    return f"{package}::{folder}::typesupport_fastrtps_cpp::"


PROGRAM: Final = r"""
#include <cstdio>
#include <iostream>
#include <map>
#include <vector>
#include <functional>
#include "fastcdr/Cdr.h"
#include "fastcdr/FastBuffer.h"
using namespace eprosima::fastcdr;
using B = std::vector<char>;
template<class M, class D, class E> B recode(B in, D decode, E encode) {
  M message;
  FastBuffer source(in.data(), in.size());
  Cdr reader(source, Cdr::DEFAULT_ENDIAN, CdrVersion::XCDRv1);
  if (!in.empty()) {
    reader.read_encapsulation();
    decode(reader, message);
  }
  B out(1 << 16, 0);
  FastBuffer target(out.data(), out.size());
  Cdr writer(target, Cdr::DEFAULT_ENDIAN, CdrVersion::XCDRv1);
  writer.set_encoding_flag(EncodingAlgorithmFlag::PLAIN_CDR);
  writer.serialize_encapsulation();
  encode(writer, message);
  out.resize(writer.get_serialized_data_length());
  return out;
}
static const std::map<std::string, std::function<B(const B &)>> types = {
TYPES};
int main() {
  std::string type, hex;
  while (std::cin >> type >> hex) {
    B in;  // empty for "-", a new message
    if (hex != "-") for (size_t i = 0; i < hex.size(); i += 2) in.push_back(static_cast<char>(std::stoi(hex.substr(i, 2), nullptr, 16)));
    for (unsigned char c : types.at(type)(in)) std::printf("%02x", c);
    std::puts("");
  }
}
"""


def hashes_in(folder: Path) -> dict[str, str]:
    """The type hashes that rosidl wrote into a package's folder."""
    files = folder.glob("*/*.json")
    found = (item for file in files for item in json.loads(file.read_text())["type_hashes"])
    return {
        item["type_name"]: item["hash_string"]
        for item in found
        if item["type_name"].startswith(f"{folder.name}/")
    }


# -- the cases


def alignment(classes: Classes) -> Iterator[tuple[str, Any]]:
    """Each kind of field after each of 8 positions, with 0, 1 and 3 elements where it is a sequence."""
    for type_ in (*definitions.PRIMITIVES, *definitions.NESTED):
        name = definitions.file_name(type_)
        cls = classes[f"conformance_msgs/msg/{name}"]
        fields = {field.name: field for field in fields_of(cls)}
        source = random.Random(name)
        for kind in definitions.KINDS:
            for position in range(8):
                for count in (0, 1, 3) if fields[kind].is_sequence else (1,):
                    message = cls()
                    setattr(message, f"lead_{kind}", list(range(1, position + 1)))
                    fill(source, message, fields[kind], count)
                    message.tail = 0xEE
                    yield f"alignment/{name}/{kind}/{position}/{count}", message
        for index in range(2):
            at = f"{name}At"
            yield f"alignment/{at}/{index}", random_message(source, classes[f"conformance_msgs/msg/{at}"])


def bundled(classes: Classes) -> Iterator[tuple[str, Any]]:
    """Random values of every type."""
    for name in sorted(classes):
        if not name.startswith(("conformance_msgs/msg/", "codec_msgs/")):
            for index in range(3):
                yield f"types/{name}/{index}", random_message(random.Random(f"{name} {index}"), classes[name])


def defaults(classes: Classes) -> Iterator[tuple[str, Any]]:
    """A new message of every type."""
    return (
        (f"default/{name}", classes[name]()) for name in sorted(classes) if not name.startswith("codec_msgs/")
    )


def big(classes: Classes) -> Iterator[tuple[str, Any]]:
    """Messages to read in big endian."""
    names = [definitions.file_name(type_) for type_ in (*definitions.PRIMITIVES, *definitions.NESTED)]
    names = [f"conformance_msgs/msg/{name}{at}" for name in names for at in ("", "At")]
    more = ("sensor_msgs/msg/JointState", "sensor_msgs/msg/PointCloud2", "visualization_msgs/msg/Marker")
    for name in (*names, *more):
        yield f"big/{name}", random_message(random.Random(f"big {name}"), classes[name])


HOSTILE: Final = (
    *("std_msgs/msg/String", "std_msgs/msg/ColorRGBA", "std_msgs/msg/UInt8MultiArray", "std_msgs/msg/Header"),
    *("geometry_msgs/msg/PoseStamped", "geometry_msgs/msg/PolygonStamped", "sensor_msgs/msg/JointState"),
    *(
        "sensor_msgs/msg/PointCloud2",
        "sensor_msgs/msg/Image",
        "sensor_msgs/msg/Imu",
        "sensor_msgs/msg/LaserScan",
    ),
    *(
        "nav_msgs/msg/Path",
        "nav_msgs/msg/OccupancyGrid",
        "tf2_msgs/msg/TFMessage",
        "visualization_msgs/msg/Marker",
    ),
    *("diagnostic_msgs/msg/DiagnosticArray", "trajectory_msgs/msg/JointTrajectory"),
    *("rcl_interfaces/msg/ParameterEvent", "rcl_interfaces/srv/SetParameters_Request"),
    *("std_srvs/srv/SetBool_Response", "action_msgs/srv/CancelGoal_Event"),
    *("conformance_msgs/msg/Defaults", "conformance_msgs/srv/Ask_Event"),
    *(
        f"conformance_msgs/msg/{definitions.file_name(type_)}"
        for type_ in (*definitions.PRIMITIVES, *definitions.NESTED)
    ),
)


def hostile(classes: Classes) -> Iterator[tuple[str, Any]]:
    """Messages that the suite cuts and damages."""
    for name in HOSTILE:
        source = random.Random(f"hostile {name}")
        messages = [random_message(source, classes[name]) for _ in range(5)]
        yield f"hostile/{name}", max(messages, key=lambda message: min(300, len(serialize(message))))


def text_payload(data: bytes, length: int | None = None) -> str:
    """A payload of std_msgs/msg/String."""
    return (b"\0\1\0\0" + struct.pack("<I", len(data) if length is None else length) + data).hex()


def text_cases() -> Iterator[str]:
    """Strings as they should be, and as they should not."""
    type_ = "std_msgs/msg/String"
    texts = [
        "",
        *("abcdefghi"[:size] for size in range(1, 10)),
        "é",
        "é€",
        "𝄞",
        "a𝄞b",
        "\ufeffa",
        "x" * 300,
        "é" * 200,
    ]
    for index, value in enumerate(texts):
        yield f"text/{index} wire {type_} {text_payload(value.encode() + bytes(1))}"
    for name, data, read in (
        ("no-nul", b"abc", [b"abc\0"]),
        ("nul-inside", b"a\0b\0", [b"a\0", b"a\0b\0"]),
        ("not-utf8", b"a\xff\0", [b"a\xff\0", "a\ufffd\0".encode()]),
        ("surrogate", b"\xed\xa0\x80\0", [b"\xed\xa0\x80\0", "\ufffd\ufffd\ufffd\0".encode()]),
    ):
        accepted = "|".join(["refused", *map(text_payload, read)])
        yield f"text/{name} recode {type_} {text_payload(data)} {accepted}"
    empty = text_payload(b"\0")
    yield f"text/length-0 recode {type_} {text_payload(b'')} refused|{empty}"
    yield f"text/length-0-long recode {type_} {text_payload(b'abcd', 0)} refused|{empty}"
    wide = "conformance_msgs/msg/WString"
    for name, unit in (("surrogate", 0xD800), ("bom", 0xFEFF), ("large", 0x10000), ("nul", 0)):
        body = struct.pack("<IIIIIIIIIB", 0, 1, unit, 0, 0, 0, 0, 0, 0, 0)
        yield f"text/wide-{name} recode {wide} {(bytes((0, 1, 0, 0)) + body + bytes(40)).hex()} any"


def float_cases() -> Iterator[str]:
    """Special numbers, and booleans other than 0 and 1."""
    for size, type_, character in ((4, "std_msgs/msg/Float32", "I"), (8, "std_msgs/msg/Float64", "Q")):
        bits = 8 * size
        quiet, infinite = ((0x7FC00000, 0x7F800000), (0x7FF8 << 48, 0x7FF0 << 48))[size == 8]
        plain = {"zero": 0, "minus-zero": 1 << bits - 1, "least": 1, "infinite": infinite, "nan": quiet}
        plain |= {"largest": infinite - 1, "minus-infinite": infinite | 1 << bits - 1}
        for name, value in plain.items():
            yield f"float/{bits}/{name} wire {type_} 00010000{struct.pack(f'<{character}', value).hex()}"
        for name, value in {
            "nan-payload": quiet | 5,
            "nan-signalling": infinite | 1,
            "nan-minus": quiet | 1 << bits - 1,
        }.items():
            payload = f"00010000{struct.pack(f'<{character}', value).hex()}"
            silent = f"00010000{struct.pack(f'<{character}', value | quiet).hex()}"
            usual = f"00010000{struct.pack(f'<{character}', quiet).hex()}"
            yield f"float/{bits}/{name} recode {type_} {payload} {payload}|{silent}|{usual}"
    for byte in (2, 128, 255):
        yield f"float/bool/{byte} recode std_msgs/msg/Bool 00010000{byte:02x} refused|0001000001"


def bound_cases() -> Iterator[str]:
    """More elements and characters than the bounds allow: refused, or read as they are."""
    empty = "00000000"
    long = struct.pack("<I", 4).hex() + "01020304"
    payload = (
        "00010000" + empty + "00" + "000000" + empty + "000000" + "00" + empty + long + empty + empty + "00"
    )
    yield f"bounds/sequence recode conformance_msgs/msg/Uint8 {payload} refused|{payload}"
    text = f"00010000{empty}{struct.pack('<I', 7).hex()}{b'abcdef'.hex()}00"
    ask = "conformance_msgs/srv/Ask_Request"
    yield f"bounds/string recode {ask} {text} refused|{text}"
    yield f"bounds/load load {ask} what#=0 how={b'abcdef'.hex()} refused|{text}"


def equal_cases() -> Iterator[str]:
    """Pairs of messages."""
    type_ = "std_msgs/msg/Float64"
    numbers = {"one": 1.0, "two": 2.0, "zero": 0.0, "minus-zero": -0.0, "nan": float("nan")}
    payloads = {name: f"00010000{struct.pack('<d', value).hex()}" for name, value in numbers.items()}
    for one, other in (
        ("one", "one"),
        ("one", "two"),
        ("zero", "minus-zero"),
        ("nan", "nan"),
        ("nan", "one"),
    ):
        result = int(numbers[one] == numbers[other])
        yield f"equal/{one}/{other} equal {type_} {payloads[one]} {payloads[other]} {result}"
    for index, (one, other) in enumerate((("abc", "abc"), ("abc", "abd"), ("abc", "ab"))):
        texts = [text_payload(value.encode() + bytes(1)) for value in (one, other)]
        yield f"equal/text/{index} equal std_msgs/msg/String {' '.join(texts)} {int(one == other)}"


def constant_cases(wheels: Wheels, registry: Any) -> Iterator[str]:
    """Every constant; those of the wheels have rosidl's values."""
    for interface in registry:
        for message in getattr(interface, "messages", (interface,)):
            cls = wheels.class_of(message.type_name) if message.constants else None
            for constant in message.constants:
                value = getattr(cls, constant.name, constant.value)
                text = text_of(constant.type, value)
                yield f"constant/{message.type_name}/{constant.name} constant {message.type_name} {constant.name} {text}"


class Goldens:
    """Writes the files, with the bytes of the real implementation."""

    def __init__(self, wheels: Wheels, compiled: Compiled) -> None:
        self.wheels = wheels
        self._compiled = compiled

    def payloads(self, messages: list[tuple[str, Any]], new: bool = False) -> list[tuple[str, str, bytes]]:
        """The name, the type and the true payload of each message; SystemExit where ours differs.

        With `new`, all messages are new ones, which the real implementation makes itself.
        """
        left: list[tuple[str, bytes]] = []
        result = []
        for name, message in messages:
            ours, cls = serialize(message), type(message)
            type_ = "/".join([*cls.__module__.split(".")[:2], cls.__name__])
            if (theirs := self.wheels.class_of(type_)) is not None:
                if not self.wheels.payload(theirs, None if new else message).startswith(ours):
                    raise SystemExit(f"{name}: rclpy writes something else")
            else:
                left.append((type_, ours))
            result.append((name, type_, ours))
        if missing := {type_ for type_, _ in left}.difference(self._compiled.types()):
            raise SystemExit(f"neither has {sorted(missing)}")
        asked = [(type_, b"" if new else ours) for type_, ours in left]
        for (type_, ours), true in zip(left, self._compiled.payloads(asked), strict=True):
            if ours != true:
                raise SystemExit(f"{type_} {ours.hex()}: Fast CDR writes {true.hex()}")
        print(f"{len(messages)} messages, {len(left)} of them in C++")
        return result


def write(file: str, lines: Iterable[str]) -> None:
    """Write one file of cases. In a case's name, `=` stands for its type."""
    CASES.mkdir(exist_ok=True)
    rows = (line.split(" ") for line in lines)
    texts = (" ".join([name.replace(type_, "="), kind, type_, *rest]) for name, kind, type_, *rest in rows)
    (CASES / file).write_text("".join(f"{text}\n" for text in texts))


def main() -> None:
    """Write all files."""
    definitions.write()
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(tempfile.mkdtemp())
    interfaces = ROOT / "interfaces"
    classes = generate(folder / "generated", interfaces, definitions.INTERFACES)
    own = [path for path in _in_order(interfaces) if not (SHARE / path.name).is_dir()]
    compiled = Compiled(folder, [*own, definitions.INTERFACES / "conformance_msgs"])
    goldens = Goldens(Wheels(), compiled)
    for file, messages in (
        ("alignment", alignment),
        ("types", bundled),
        ("default", defaults),
        ("hostile", hostile),
    ):
        kind = file if file in ("default", "hostile") else "wire"
        cases = goldens.payloads(list(messages(classes)), new=file == "default")
        write(f"{file}.txt", (f"{name} {kind} {type_} {data.hex()}" for name, type_, data in cases))
    pairs = list(big(classes))
    cases = goldens.payloads(pairs)
    lines = (
        f"{name} recode {type_} {big_endian(message).hex()} {data.hex()}"
        for (name, type_, data), (_, message) in zip(cases, pairs, strict=True)
    )
    write("big_endian.txt", lines)
    hashes = {**compiled.hashes}
    for path in interfaces.iterdir():
        hashes |= hashes_in(SHARE / path.name)
    made = (text_cases(), float_cases(), bound_cases(), equal_cases())
    constants = constant_cases(goldens.wheels, ifgen.load(interfaces, definitions.INTERFACES))
    write("values.txt", chain(*made, constants))
    write("hashes.txt", (f"hash/{name} hash {name} {value}" for name, value in sorted(hashes.items())))


def _in_order(interfaces: Path) -> Iterator[Path]:
    """The packages with interfaces, those first that others need."""
    paths = {path.name: path for path in sorted(interfaces.iterdir()) if any(path.glob("[msa][srca]*/*.*"))}
    done: set[str] = set()

    def visit(name: str) -> Iterator[Path]:
        if name in done or name not in paths:
            return
        done.add(name)
        for needed in re.findall(r"<(?:\w+_)?depend>(\w+)<", (paths[name] / "package.xml").read_text()):
            yield from visit(needed)
        yield paths[name]

    for name in paths:
        yield from visit(name)


if __name__ == "__main__":
    if os.environ.get("GLIBC_TUNABLES") != TUNABLES:
        os.environ["GLIBC_TUNABLES"] = TUNABLES
        os.execv(sys.executable, [sys.executable, "-m", "tests.conformance.make_cases", *sys.argv[1:]])
    main()
