"""The C extension. What pyproject.toml could say of it is experimental, and setuptools warns of that."""

from setuptools import Extension, setup

SOURCES = (
    *("module", "fastcdr", "layout", "message", "service", "slots"),
    *("table", "codec_arrays", "codec_attach", "codec_buffer", "codec_module"),
    *("codec_numbers", "codec_read", "codec_text", "codec_write"),
    *("codec_copy", "codec_equal", "codec_methods"),
)
HEADERS = ("native", "layout", "rosidl", "table", "codec", "codec_registers", "codec_wire")

setup(
    ext_modules=[
        Extension(
            "ifgen_native._native",
            sources=[f"src/{name}.c" for name in SOURCES],
            depends=[f"src/{name}.h" for name in HEADERS],
            extra_compile_args=["-std=c11", "-O2", "-Wall", "-Wextra", "-fvisibility=hidden"],
            extra_link_args=["-s"],
            py_limited_api=True,
        )
    ],
    options={"bdist_wheel": {"py_limited_api": "cp311"}},
)
