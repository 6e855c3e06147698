"""Pictures as files: text in them, PNG, GIF, and MP4 where ffmpeg is."""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Callable, Iterable, Iterator, Sequence
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np

from ..simulation.rendering import Picture, RenderingError, image

_INK, _PAPER = (255, 255, 255), (28, 33, 40)
_LINE = 0.062  # height of the letters, as a share of that of the picture
_COLOURS, _BRIGHT_COLOURS = 56, 12
_BRIGHT = 90  # difference of the greatest and the least part of a colour
_SAMPLES = 16  # pictures whose common colours a palette is made of
_FFMPEG = (
    *("ffmpeg", "-y", "-loglevel", "error", "-f", "rawvideo", "-pix_fmt", "rgb24"),
    *("-s", "{width}x{height}", "-r", "{rate}", "-i", "-"),
    *("-pix_fmt", "yuv420p", "-movflags", "+faststart", "{path}"),
)


def check_format(path: Path) -> None:
    """Raise RenderingError if pictures of this kind cannot be written here."""
    image()
    if path.suffix.lower() == ".mp4" and shutil.which("ffmpeg") is None:
        raise RenderingError(
            f"--record: {path.name} needs ffmpeg, which is not on PATH; .gif needs nothing more"
        )


def write_line(picture: Picture, left: str, right: str) -> Picture:
    """Return a picture with a line below it: one text at the left, one at the right."""
    pillow = image()
    drawing, fonts = _part(pillow, "ImageDraw"), _part(pillow, "ImageFont")
    height, width, _ = picture.shape
    size = max(11, round(height * _LINE * 0.72))
    edge = round(height * _LINE * 1.35)
    font = fonts.load_default(size)
    canvas = pillow.fromarray(picture)
    draw = drawing.Draw(canvas)
    draw.rectangle([0, height - edge, width, height], fill=_PAPER)
    middle, margin = height - edge / 2, round(size * 0.8)
    draw.text((margin, middle), left, fill=_INK, font=font, anchor="lm")
    draw.text((width - margin, middle), right, fill=_INK, font=font, anchor="rm")
    return np.array(canvas)


def save_png(picture: Picture, path: Path) -> None:
    """Write one picture."""
    image().fromarray(picture).save(path)


def save_gif(pictures: Sequence[Picture], path: Path, frame_time: int) -> None:
    """Write an animation that repeats; `frame_time` is in milliseconds. Raises RenderingError."""
    if not pictures:
        raise RenderingError("there is no picture to make an animation of")
    pillow = image()
    palette = _palette(pillow, pictures)
    frames = [pillow.fromarray(picture).quantize(palette=palette, dither=0) for picture in pictures]
    frames[0].save(path, save_all=True, append_images=frames[1:], duration=frame_time, loop=0)


def _palette(pillow: ModuleType, pictures: Sequence[Picture]) -> Any:
    """Return one palette for all pictures: otherwise colours flicker, and the file is larger.

    Footsteps and arrows are small, and not in all of them, so the bright colours of each picture count.
    """
    coarse = [picture[::2, ::2].reshape(-1, 3) for picture in pictures]
    pixels = np.concatenate(coarse[:: max(1, len(coarse) // _SAMPLES)])
    bright = np.concatenate([each[np.ptp(each.astype(np.int16), axis=1) > _BRIGHT] for each in coarse])
    colours: list[int] = []
    often, rare = pillow.Quantize.MEDIANCUT, pillow.Quantize.MAXCOVERAGE
    parts = ((pixels, _COLOURS, often), (bright, _BRIGHT_COLOURS, often), (bright, _BRIGHT_COLOURS, rare))
    for some, count, method in parts:
        if len(some):
            found = pillow.fromarray(some[None]).quantize(count, method).getpalette() or []
            colours += found[: 3 * count]
    palette = pillow.new("P", (1, 1))
    palette.putpalette(colours)
    return palette


def save_mp4(pictures: Iterable[Picture], path: Path, frame_time: int) -> None:
    """Write a film by ffmpeg; `frame_time` is in milliseconds. Raises RenderingError."""
    pictures = iter(pictures)
    first = next(pictures, None)
    if first is None:
        raise RenderingError("there is no picture to make a film of")
    height, width, _ = first.shape
    words = {"width": width, "height": height, "rate": 1000 / frame_time, "path": path}
    command = [word.format(**words) for word in _FFMPEG]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stderr=subprocess.PIPE) as ffmpeg:
        assert ffmpeg.stdin is not None
        assert ffmpeg.stderr is not None
        try:
            ffmpeg.stdin.write(first.tobytes())
            for picture in pictures:
                ffmpeg.stdin.write(picture.tobytes())
            ffmpeg.stdin.close()
        except BrokenPipeError:
            pass  # it says why on stderr
        problem = ffmpeg.stderr.read().decode(errors="replace").strip()
    if ffmpeg.returncode:
        raise RenderingError(f"ffmpeg: {problem or f'exit code {ffmpeg.returncode}'}")


def counted(pictures: Iterator[Picture], total: int, tell: Callable[[int, int], None]) -> Iterator[Picture]:
    """Pass pictures on, and tell how many there were, of how many."""
    for number, picture in enumerate(pictures, 1):
        tell(number, total)
        yield picture


def _part(pillow: ModuleType, name: str) -> ModuleType:
    return import_module(f"{pillow.__package__}.{name}")
