"""The C extension. What pyproject.toml could say of it is experimental, and setuptools warns of that."""

from pathlib import Path

from setuptools import Extension, setup

setup(
    ext_modules=[
        Extension(
            "ifgen_native._native",
            sources=[str(path) for path in sorted(Path("src").glob("*.c"))],
            depends=[str(path) for path in Path("src").glob("*.h")],
            extra_compile_args=[
                *("-std=c11", "-O2", "-fvisibility=hidden"),
                *(
                    "-Wall",
                    "-Wextra",
                    "-Werror=implicit-function-declaration",
                ),  # C cuts pointers that such functions return
            ],
            extra_link_args=["-s"],
            py_limited_api=True,
        )
    ],
    options={"bdist_wheel": {"py_limited_api": "cp311"}},
)
