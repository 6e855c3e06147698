"""Installs the library of the humanoid's nodes, and its launch and parameter files."""

from pathlib import Path

from setuptools import find_packages, setup

SHARE = "share/humanoid"

setup(
    name="humanoid",
    version="0.1.0",
    packages=find_packages(),
    package_data={"humanoid.show.web": ["*.html", "*.js", "*.css", "three/*"]},
    data_files=[
        ("share/ament_index/resource_index/packages", ["resource/humanoid"]),
        (SHARE, ["package.xml"]),
        (f"{SHARE}/launch", sorted(map(str, Path("launch").glob("*.py")))),
        *(
            (f"{SHARE}/{folder}", sorted(map(str, Path(folder).glob("*.yaml"))))
            for folder in ("config", "config/scenarios")
        ),
    ],
    # MuJoCo exactly: other versions give other trajectories, so other state hashes.
    install_requires=["setuptools", "mujoco-core==4.0.0", "numpy", "pillow", "pyyaml"],
    zip_safe=False,
    maintainer="ifgen maintainers",
    maintainer_email="maintainers@ifgen.invalid",
    description="A humanoid in MuJoCo: the library of its nodes, and what brings them up together.",
    license="Apache-2.0",
    entry_points={
        "console_scripts": [
            "audience = humanoid.show.audience:main",
            "director = humanoid.show.referee:main",
        ],
    },
)
