"""`ifgen.activate`: the packages of one transport or the other, never a mixture. Each case needs a process."""

from __future__ import annotations

import importlib.util
import json
import os
import subprocess
import sys
from pathlib import Path

import ifgen
import pytest
from ifgen.activation import overlays

CODE = Path(ifgen.__file__).parent.parent
ELSEWHERE = Path(Path.cwd().root)  # no project
SAY_WHERE = (
    "print(*(sys.modules[n].__file__ for n in ('std_msgs', 'humanoid_interfaces') if n in sys.modules))"
)


@pytest.fixture
def fake_ros(tmp_path: Path) -> Path:
    """A folder with an rclpy and a std_msgs that are not ours."""
    for package in ("rclpy", "std_msgs"):
        (tmp_path / "ros" / package).mkdir(parents=True)
        (tmp_path / "ros" / package / "__init__.py").touch()
    return tmp_path / "ros"


def run(program: str, *path: Path, options: tuple[str, ...] = ("-S",), folder: Path = ELSEWHERE) -> str:
    """Run a program on a Python without site-packages, so that a ROS is there only if the test adds one."""
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(map(str, (*path, CODE)))}
    command = [sys.executable, *options, "-c", f"import sys, ifgen\n{program}"]
    found = subprocess.run(
        command, cwd=folder, env=environment, capture_output=True, text=True, timeout=60, check=False
    )
    return found.stdout.strip() or found.stderr.strip().splitlines()[-1]


def test_local_wins_over_an_installed_ros(fake_ros: Path) -> None:
    program = (
        "print(ifgen.activate('local'), ifgen.activate('local'))\nimport std_msgs, humanoid_interfaces\n"
    )
    said, places = run(program + SAY_WHERE, fake_ros).splitlines()
    assert said == "local local"
    assert str(fake_ros) not in places
    program = "ifgen.activate('local'); ifgen.activate('local'); print([p for p in sys.path if p.endswith('generated')])"
    assert run(program, fake_ros).count("generated") == 1


def test_rclpy_is_the_real_one_and_ours_fill_the_gaps(fake_ros: Path) -> None:
    program = (
        "print(ifgen.activate('rclpy'))\nimport rclpy, std_msgs, humanoid_interfaces\nprint(rclpy.__file__)\n"
    )
    said, rclpy, places = run(program + SAY_WHERE, fake_ros).splitlines()
    std_msgs, humanoid = places.split()
    assert said == "rclpy"
    assert str(fake_ros) in rclpy
    assert str(fake_ros) in std_msgs
    assert str(fake_ros) not in humanoid
    assert run("print(ifgen.activate('auto'))", fake_ros) == "rclpy"


def test_without_a_ros() -> None:
    assert run("print(ifgen.activate())") == "local"
    said = run("ifgen.activate('rclpy')")
    assert said.startswith(
        "ifgen.activation.ActivationError: there is no real rclpy to import: source /opt/ros/"
    )
    assert run("ifgen.activate('ros1')").startswith(
        "ValueError: transport must be 'local', 'rclpy' or 'auto'"
    )


def test_a_program_may_change_its_choice_before_the_first_import(fake_ros: Path) -> None:
    program = "ifgen.activate('local')\nprint(ifgen.activate('rclpy'))\nimport std_msgs\n"
    assert str(fake_ros) in run(program + SAY_WHERE, fake_ros)


def test_a_mixture_is_refused(fake_ros: Path) -> None:
    said = run("import std_msgs\nifgen.activate('local')", fake_ros)
    assert said == (
        f"ifgen.activation.ActivationError: 'std_msgs' is already imported from {fake_ros}/std_msgs (ROS), which does "
        "not match the local transport: call ifgen.activate('local') before the first import of rclpy or a message "
        "package"
    )
    said = run("ifgen.activate('local')\nimport std_msgs\nifgen.activate('rclpy')", fake_ros)
    assert "'std_msgs' is already imported from" in said
    assert "(local transport), which does not match the real rclpy" in said


def test_ours_where_ros_has_none_is_no_mixture(fake_ros: Path) -> None:
    assert (
        run("ifgen.activate('local')\nimport humanoid_interfaces\nprint(ifgen.activate('rclpy'))", fake_ros)
        == "rclpy"
    )


def test_auto_stays_with_what_is_imported(fake_ros: Path) -> None:
    assert run("import rclpy\nprint(ifgen.activate('auto'))", fake_ros) == "rclpy"


def test_packages_that_a_user_generated_count_as_ours(tmp_path: Path) -> None:
    ifgen.generate(CODE.parent / "interfaces" / "std_msgs", output=tmp_path)
    assert run("import std_msgs\nprint(ifgen.activate('local'))", tmp_path) == "local"


@pytest.mark.parametrize("transport", ["local", "rclpy"])
def test_a_package_of_ones_own_wins_over_a_bundled_one_of_that_name(
    transport: str, fake_ros: Path, tmp_path: Path
) -> None:
    own = tmp_path / "generated"
    (tmp_path / "ws/humanoid_interfaces/msg").mkdir(parents=True)
    (tmp_path / "ws/humanoid_interfaces/msg/Mine.msg").write_text("int32 x\n")
    ifgen.generate(tmp_path / "ws", output=own)
    program = f"from pathlib import Path\nifgen.activate({transport!r}, Path({str(own)!r}))\n"
    program += (
        "import humanoid_interfaces, std_msgs\nprint(humanoid_interfaces.__file__, std_msgs.__file__)\n"
    )
    mine, std_msgs = run(program, fake_ros).split()
    assert Path(mine).is_relative_to(own)
    assert Path(std_msgs).is_relative_to(fake_ros) == (transport == "rclpy")


def test_packages_of_nodes_are_found_in_the_output_folder(tmp_path: Path) -> None:
    """No option is needed, as with `ifgen run`: `output` of the project, whose packages may have our demo's names."""
    nodl = tmp_path / "ws/teleop/nodl"
    nodl.mkdir(parents=True)
    (nodl / "teleop.nodl.yaml").write_text("nodl_version: 2\ndescription: Mine.\n")
    (tmp_path / "pyproject.toml").write_text('[tool.ifgen]\npaths = ["ws"]\noutput = "out"\n')
    ifgen.generate(tmp_path / "ws", output=tmp_path / "out")
    found = "import teleop.teleop\nprint(teleop.__file__)\nifgen.activate('local')\nprint(len(sys.path) == len(set(sys.path)))"
    for arguments in ("", ", 'out'", ", __import__('pathlib').Path('out')"):
        program = f"print(ifgen.activate('local'{arguments}))\n{found}"
        said, place, once = run(program, options=(), folder=tmp_path).splitlines()
        assert (said, once) == ("local", "True")
        assert Path(place).is_relative_to(tmp_path)


def test_mistakes_in_what_is_asked_for(tmp_path: Path) -> None:
    assert run("ifgen.activate('local', 'nowhere')") == (
        "ifgen.activation.ActivationError: there is no folder 'nowhere'; `ifgen generate -o nowhere` makes one"
    )
    (tmp_path / "pyproject.toml").write_text("[tool.ifgen]\nnope = 1\n")
    program = "try:\n    ifgen.activate('local')\nexcept ifgen.InputError as error:\n    print(error)"
    assert "nope" in run(program, options=(), folder=tmp_path)


@pytest.mark.parametrize(
    ("place", "name", "transport"),
    [
        *((place, "teleop", "local") for place in ("beside", "module", "site-packages", "run", "run -m")),
        *(
            (place, "humanoid_interfaces", "local")
            for place in ("beside", "PYTHONPATH", "site-packages", "run")
        ),
        ("run beside", "humanoid_interfaces", "local"),
        ("PYTHONPATH", "humanoid_interfaces", "rclpy"),
    ],
)
def test_what_is_the_users_wins_over_our_examples(
    place: str, name: str, transport: str, fake_ros: Path, tmp_path: Path
) -> None:
    """The user's packages win wherever they are, and however they are found."""
    package = tmp_path / ("lib" if place in {"PYTHONPATH", "site-packages", "run"} else "app") / name
    package.mkdir(parents=True)
    (package / "__init__.py").write_text("SPEED = 3\n")
    (tmp_path / "app").mkdir(exist_ok=True)
    use = f"from {name} import SPEED\nimport std_msgs\nprint(SPEED)\n"
    alone = "import sys, ifgen\n"
    if place == "site-packages":
        alone += f"sys.path.append({str(tmp_path / 'lib')!r})\n"
    alone += f"ifgen.activate({transport!r})\n"
    (tmp_path / "app/main.py").write_text(use if place.startswith("run") else alone + use)
    path = [CODE, *([tmp_path / "lib"] if place in {"PYTHONPATH", "run"} else [])]
    words = {
        "module": ["-m", "main"],
        "run": ["-m", "ifgen", "run", "--transport", transport, "main.py"],
        "run beside": ["-m", "ifgen", "run", "--transport", transport, "main.py"],
        "run -m": ["-m", "ifgen", "run", "--transport", transport, "-m", "main"],
    }.get(place, ["main.py"])
    done = subprocess.run(
        [sys.executable, *words],
        cwd=tmp_path / "app",
        env={**os.environ, "PYTHONPATH": os.pathsep.join(map(str, [*path, fake_ros]))},
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    assert (done.returncode, done.stdout) == (0, "3\n"), done.stderr


def replacing(folder: Path, sources: Path, name: str, fields: str = "bool mine\n") -> None:
    """A generated package, in a folder, that a ROS has with another definition."""
    (sources / name / "msg").mkdir(parents=True)
    (sources / name / "msg/Flag.msg").write_text(fields)
    ifgen.generate(sources / name, output=folder)


@pytest.fixture
def fake_overlaid_ros(tmp_path: Path) -> Path:
    """A ROS with an rclpy, a `flags` that nobody uses, and a `parts` that `whole` is compiled with."""
    entry = tmp_path / "ros/lib/python3/site-packages"
    for name, text in {
        "rclpy": "",
        "flags/msg": "",
        "parts/msg": "",
        "whole/msg": "from parts.msg import Flag\n",
    }.items():
        (entry / name).mkdir(parents=True)
        (entry / name / "__init__.py").write_text(text)
        (entry / name.partition("/")[0] / "__init__.py").touch()
    return entry


SLOW = [pytest.param(place, marks=pytest.mark.slow) for place in ("run beside", "PYTHONPATH", "run output")]
PLACES = ["beside", "site-packages", "output", *SLOW]


@pytest.mark.parametrize("transport", ["local", "rclpy"])
@pytest.mark.parametrize("name", ["flags", "parts"])
@pytest.mark.parametrize("place", PLACES)
def test_the_users_definition_wins_over_that_of_ros_or_is_refused(
    place: str, name: str, transport: str, fake_overlaid_ros: Path, tmp_path: Path
) -> None:
    ros, app = fake_overlaid_ros, tmp_path / "app"
    folder = {"beside": app, "run beside": app, "output": app / "generated", "run output": app / "generated"}
    own = folder.get(place, tmp_path / "lib")
    replacing(own, tmp_path / "sources", name)
    app.mkdir(exist_ok=True)
    use = f"import {name}\nprint({name}.__file__)\n"
    if not place.startswith("run"):
        first = f"sys.path.append({str(own)!r})\n" if place == "site-packages" else ""
        use = f"import sys, ifgen\n{first}ifgen.activate({transport!r})\n{use}"
    (app / "main.py").write_text(use)
    words = ["-m", "ifgen", "run", "--transport", transport] if place.startswith("run") else []
    path = [CODE, *([own] if place == "PYTHONPATH" else []), ros]
    done = subprocess.run(
        [sys.executable, *words, "main.py"],
        cwd=app,
        env={**os.environ, "PYTHONPATH": os.pathsep.join(map(str, path))},
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    if transport == "rclpy" and name == "parts":
        assert done.returncode and not done.stdout
        said = " ".join(done.stderr.split())
        assert f"'parts' in {own} has other definitions than the one of ROS in {ros}/parts" in said
        assert "'whole' was compiled with: give your package another name, or use --transport local" in said
    else:
        assert (done.returncode, done.stdout) == (0, f"{own}/{name}/__init__.py\n"), done.stderr


@pytest.mark.parametrize("transport", ["local", "rclpy"])
def test_a_package_beside_the_program_wins_over_the_output_folder(
    transport: str, fake_overlaid_ros: Path, tmp_path: Path
) -> None:
    replacing(tmp_path / "app", tmp_path / "sources", "mine")
    replacing(tmp_path / "project/generated", tmp_path / "others", "mine")
    main = tmp_path / "app/main.py"
    main.write_text(f"import ifgen\nifgen.activate({transport!r})\nimport mine\nprint(mine.__file__)\n")
    done = subprocess.run(
        [sys.executable, str(main)],
        cwd=tmp_path / "project",
        env={**os.environ, "PYTHONPATH": os.pathsep.join(map(str, [CODE, fake_overlaid_ros]))},
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    assert done.stdout == f"{tmp_path}/app/mine/__init__.py\n", done.stderr


def test_an_equal_package_leaves_those_of_ros_in_place(fake_overlaid_ros: Path, tmp_path: Path) -> None:
    """ROS says by its shared files that it has the same definition."""
    own = tmp_path / "app/generated"
    replacing(own, tmp_path / "sources", "parts")
    (known,) = (h for _, name, h in overlays._hashes(own / "parts") if name == "Flag")
    share = tmp_path / "ros/share/parts/msg/Flag.json"
    share.parent.mkdir(parents=True)
    share.write_text(json.dumps({"type_hashes": [{"type_name": "parts/msg/Flag", "hash_string": known}]}))
    real = [str(fake_overlaid_ros)]
    assert overlays.path_on_ros(real, real, [str(own)], []) == [*real, str(own)]
    replacing(own, tmp_path / "more", "flags")
    with pytest.raises(overlays.OverlayError, match=r"replace those of ROS .flags., and a copy of 'parts'"):
        overlays.path_on_ros(real, real, [str(own)], [])


def test_nodes_of_our_demo_are_there_for_whoever_asks_for_the_demo() -> None:
    find = "import importlib.util as u\nprint([bool(u.find_spec(n)) for n in ('teleop._teleop_base', 'humanoid_interfaces')])"
    assert run(f"ifgen.activate('local')\n{find}") == "[False, True]"
    examples = CODE.parent / "examples/humanoid"
    assert run(f"ifgen.activate('local')\n{find}", examples) == "[True, True]"


@pytest.mark.skipif(
    importlib.util.find_spec("rclpy") is None, reason="the ros-jazzy-rclpy wheel is not installed"
)
def test_the_real_one() -> None:
    program = "import ifgen\nprint(ifgen.activate())\nimport rclpy, std_msgs.msg\nprint(hasattr(rclpy, 'init'), std_msgs.__file__)"
    found = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, timeout=60, check=True
    )
    said, real = found.stdout.splitlines()
    assert said == "rclpy"
    assert real.startswith("True ")
    assert str(CODE.parent / "generated") not in real
