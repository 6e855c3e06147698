"""Pictures of what the robot did."""

from __future__ import annotations

import math
import shutil
import subprocess
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from humanoid.control.posture import standing
from humanoid.control.reference import GaitParameters
from humanoid.data import SECOND, Footstep, Leg, Mode
from humanoid.robot.model import HumanoidModel
from humanoid.robot.obstacles import Solid
from humanoid.show import film, pictures
from humanoid.show.film import Film, Shot, View, views
from humanoid.simulation import rendering
from humanoid.simulation.rendering import Picture, RenderingError
from humanoid.spatial import Array
from PIL import Image

WIDTH, HEIGHT = 320, 240
FEET = (np.array([0.0, 0.09, 0.0]), np.array([0.0, -0.09, 0.0]))


@pytest.fixture(scope="module")
def posture(model: HumanoidModel) -> Array:
    joints, base = standing(model, FEET, GaitParameters())
    data = model.data()
    data.qpos[:3] = base
    data.qpos[model.qpos] = joints
    found: Array = data.qpos.copy()
    return found


@pytest.fixture(scope="module")
def camera(model: HumanoidModel) -> Iterator[Film]:
    try:
        rendering.choose_gl()
    except RenderingError as error:
        pytest.skip(str(error))
    camera = Film(model, WIDTH, HEIGHT)
    yield camera
    camera.close()


def drawn(camera: Film, shot: Shot) -> Array:
    """A picture without its line of text, as numbers that can be subtracted."""
    (view,) = views([shot])
    return camera.draw(shot, view, "").astype(int)[: HEIGHT - 24]


def coloured(picture: Array, strong: int, *weak: int) -> int:
    """How many pixels have much more of one colour than of others."""
    return int(np.all([picture[..., strong] > picture[..., each] + 60 for each in weak], axis=0).sum())


def at(posture: Array, x: float, yaw: float) -> Array:
    moved = posture.copy()
    moved[0] = x
    moved[3:7] = math.cos(yaw / 2), 0.0, 0.0, math.sin(yaw / 2)
    return moved


def test_the_camera_goes_and_turns_with_the_robot(camera: Film, posture: Array) -> None:
    plain = drawn(camera, Shot(0, posture))
    moved = drawn(camera, Shot(0, at(posture, 2.0, 2.0)))
    middle = (slice(50, 110), slice(145, 175))  # torso and head, which show their front
    assert np.abs(moved[middle] - plain[middle]).mean() < 20
    assert coloured(plain[middle], 2, 0) > 40  # the panel on the chest


def test_goal_and_footsteps_are_on_the_floor_and_a_push_is_an_arrow(camera: Film, posture: Array) -> None:
    plain = drawn(camera, Shot(0, posture))
    steps = (Footstep(0, Leg.RIGHT, 0.3, -0.09, 0.0), Footstep(1, Leg.LEFT, 0.5, 0.09, 0.0))
    stepping = drawn(camera, Shot(0, posture, steps))
    assert coloured(stepping, 1, 0, 2) > 30 > coloured(plain, 1, 0, 2)
    assert coloured(stepping, 0, 2) > coloured(plain, 0, 2) + 30
    going = drawn(camera, Shot(0, posture, goal=(0.4, 0.1, 0.0)))
    changed = np.abs(going - plain).sum(axis=2) > 60
    assert coloured(going, 2, 0) > coloured(plain, 2, 0) + 60
    assert not changed[:120].any()  # flat, and low in the picture
    pushed = drawn(camera, Shot(0, posture, push=(0.0, -40.0)))
    assert coloured(pushed, 0, 1, 2) > 60 > coloured(plain, 0, 1, 2)


def test_obstacles_stand_as_wide_and_as_high_as_they_are(camera: Film, posture: Array) -> None:
    solids = (
        Solid("pillar", "cylinder", (0.9, 0.05, 0.1), -0.2, 0.7, 0.2, 1.0),
        Solid("box", "box", (0.05, 0.7, 0.1), -0.2, -0.7, 0.4, 0.4),
    )
    empty = drawn(
        camera, Shot(0, posture, solids=(Solid("far", "box", (0.0, 0.0, 0.0), -90.0, 0.0, 0.1, 0.1),))
    )
    full = drawn(camera, Shot(0, posture, solids=solids))
    for strong, weak, slim in ((0, (1, 2), True), (1, (0, 2), False)):
        changed = np.all([full[..., strong] > full[..., each] + 50 for each in weak], axis=0)
        changed &= np.abs(full - empty).sum(axis=2) > 60
        rows, columns = np.nonzero(changed)
        assert len(rows) > 100
        assert (np.ptp(rows) > 2 * np.ptp(columns)) == slim


def test_a_line_says_time_mode_speed_and_how_fast_the_film_is(
    camera: Film, posture: Array, monkeypatch: pytest.MonkeyPatch
) -> None:
    said: list[tuple[str, str]] = []

    def note(picture: Picture, left: str, right: str) -> Picture:
        said.append((left, right))
        return picture

    monkeypatch.setattr(film, "write_line", note)
    view = View(0.0, 0.0, 0.0, 0.44)
    camera.draw(Shot(3 * SECOND // 2, posture, mode=Mode.WALKING, push=(1.0, 0.0)), view, "2x speed")
    camera.draw(Shot(12 * SECOND, posture, mode=Mode.EMERGENCY_STOP), view, "real speed")
    assert said == [
        ("  1.5 s   walking, 0.44 m/s, pushed", "2x speed"),
        (" 12.0 s   emergency stop", "real speed"),
    ]


def test_words_are_in_the_picture() -> None:
    empty = np.full((HEIGHT, WIDTH, 3), 200, dtype=np.uint8)
    with_words = pictures.write_line(empty, "left", "right")
    without = pictures.write_line(empty, "", "")
    changed = np.argwhere((with_words != without).any(axis=2))
    assert changed[:, 0].min() > HEIGHT - 24  # nothing above the line
    assert changed[:, 1].min() < 20
    assert changed[:, 1].max() > WIDTH - 20
    assert (with_words[: HEIGHT - 24] == 200).all()


def test_views_are_calm() -> None:
    """A robot that walks 0.5 m/s, sways, and turns through the place where angles jump."""
    shots: list[Shot] = []
    for number in range(100):
        posture = np.zeros(7)
        posture[0] = 0.05 * number
        posture[1] = 0.03 * math.sin(number)
        yaw = 2.0 + 0.03 * number
        posture[3:7] = math.cos(yaw / 2), 0.0, 0.0, math.sin(yaw / 2)
        shots.append(Shot(number * SECOND // 10, posture))
    found = views(shots)
    turns = np.diff([view.azimuth for view in found])
    assert turns[40:-40] == pytest.approx(math.degrees(0.03), abs=0.01)
    assert np.abs(turns).max() < 2.0
    assert max(abs(view.y) for view in found) < 0.02
    assert found[50].speed == pytest.approx(0.5, abs=0.01)
    assert views([]) == []


def test_pictures_become_files(tmp_path: Path) -> None:
    shades = [np.full((HEIGHT, WIDTH, 3), shade, dtype=np.uint8) for shade in (10, 100, 200)]
    pictures.save_png(shades[0], tmp_path / "one.png")
    with Image.open(tmp_path / "one.png") as image:
        assert np.array_equal(np.asarray(image), shades[0])
    pictures.save_gif(shades, tmp_path / "some.gif", 100)
    with Image.open(tmp_path / "some.gif") as image:
        assert (getattr(image, "n_frames", 1), image.size) == (3, (WIDTH, HEIGHT))
    for save in (pictures.save_gif, pictures.save_mp4):
        with pytest.raises(RenderingError):
            save([], tmp_path / "none", 100)


def test_rare_colours_keep_their_places_in_an_animation(tmp_path: Path) -> None:
    """Thousands of greys, and in one picture a small red arrow."""
    greys = np.arange(HEIGHT * WIDTH, dtype=np.int64) * 7919 % 251
    pale = np.repeat(greys.astype(np.uint8), 3).reshape(HEIGHT, WIDTH, 3)
    marked = pale.copy()
    marked[10:20, 10:20] = 240, 30, 50
    pictures.save_gif([pale, marked], tmp_path / "a.gif", 100)
    with Image.open(tmp_path / "a.gif") as image:
        image.seek(1)
        assert np.abs(np.asarray(image.convert("RGB"))[15, 15].astype(int) - (240, 30, 50)).max() < 12


@pytest.mark.skipif(shutil.which("ffmpeg") is None, reason="ffmpeg is not on PATH")
def test_ffmpeg_makes_a_film_of_them(tmp_path: Path) -> None:
    shades = [np.full((HEIGHT, WIDTH, 3), shade, dtype=np.uint8) for shade in range(10, 250, 24)]
    pictures.save_mp4(iter(shades), tmp_path / "a.mp4", 50)
    command = [
        "ffmpeg",
        "-v",
        "error",
        "-i",
        str(tmp_path / "a.mp4"),
        "-f",
        "rawvideo",
        "-pix_fmt",
        "gray",
        "-",
    ]
    done = subprocess.run(command, capture_output=True, check=True, timeout=60)
    frames = np.frombuffer(done.stdout, dtype=np.uint8).reshape(-1, HEIGHT * WIDTH)
    assert frames.mean(axis=1) == pytest.approx([shade.mean() for shade in shades], abs=4)
    with pytest.raises(RenderingError, match="ffmpeg: "):
        pictures.save_mp4(iter(shades), tmp_path / "none" / "a.mp4", 50)


def test_a_film_needs_ffmpeg(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(shutil, "which", lambda name: None)
    with pytest.raises(RenderingError, match=r"a\.mp4 needs ffmpeg, which is not on PATH; \.gif needs"):
        pictures.check_format(Path("a.mp4"))
