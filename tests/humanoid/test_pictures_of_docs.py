"""The pictures in docs: each frame of them shows something."""

from __future__ import annotations

from pathlib import Path

import pytest
from PIL import Image

DOCS = Path(__file__).parents[2] / "docs"
PICTURES = sorted(path for kind in ("gif", "png", "jpg", "webp") for path in DOCS.rglob(f"*.{kind}"))
MOST = 0.9  # share of one colour
ALIKE = 16  # parts of red, green and blue that count as the same


def share_of_one_colour(picture: Image.Image) -> float:
    """The share of the most frequent colour, where those that are nearly alike count as one."""
    small = picture.convert("RGB").resize((96, 72), Image.Resampling.BOX)
    coarse = small.point([value // ALIKE * ALIKE for value in range(256)] * 3)
    counts = coarse.getcolors(96 * 72)
    assert counts is not None
    return max(count for count, _ in counts) / (96 * 72)


def test_a_black_picture_is_noticed() -> None:
    black = Image.new("RGB", (480, 360), (10, 10, 13))
    black.paste((40, 90, 160), (0, 340, 480, 360))
    assert share_of_one_colour(black) >= MOST


@pytest.mark.parametrize("path", PICTURES, ids=lambda path: path.name)
def test_no_frame_is_mostly_one_colour(path: Path) -> None:
    with Image.open(path) as picture:
        for number in range(getattr(picture, "n_frames", 1)):
            picture.seek(number)
            assert share_of_one_colour(picture) < MOST, f"frame {number}"
