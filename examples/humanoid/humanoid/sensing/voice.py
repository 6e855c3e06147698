"""A voice for tests and scenarios: a handful of words from formants, harmonics and noise.

No human speaks like this. It gives the spotter of words in `hearing.py` something to hear, with another
pitch, speed and loudness each time, and the spotter's own patterns.
"""

from __future__ import annotations

from collections.abc import Sequence
from types import MappingProxyType
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..spatial import Array

RATE = 16_000  # samples per second
PAUSE = 0.18  # s between two words


class Phone(NamedTuple):
    """A sound: three formants [Hz], how long it lasts [s], and how loud voice and noise are."""

    formants: tuple[float, float, float]
    seconds: float
    voice: float
    noise: float = 0.0


_PHONES = MappingProxyType(
    {
        "a": Phone((730, 1150, 2440), 0.14, 1.0),
        "ae": Phone((660, 1720, 2410), 0.13, 1.0),
        "e": Phone((450, 2000, 2600), 0.13, 1.0),
        "i": Phone((290, 2250, 2950), 0.12, 1.0),
        "o": Phone((480, 850, 2400), 0.15, 1.0),
        "u": Phone((310, 870, 2250), 0.10, 0.8),
        "r": Phone((330, 1100, 1500), 0.08, 0.7),
        "l": Phone((360, 1000, 2700), 0.07, 0.6),
        "m": Phone((250, 1000, 2200), 0.09, 0.4),
        "n": Phone((250, 1500, 2500), 0.08, 0.4),
        "v": Phone((220, 1100, 2200), 0.07, 0.3, 0.1),
        "s": Phone((4200, 5200, 6200), 0.12, 0.0, 0.6),
        "h": Phone((600, 1300, 2500), 0.06, 0.0, 0.3),
        "b": Phone((200, 800, 2200), 0.03, 0.3),
        "d": Phone((250, 1700, 2600), 0.03, 0.3, 0.1),
        "k": Phone((1500, 2200, 3000), 0.04, 0.0, 0.5),
        "p": Phone((700, 1100, 2300), 0.03, 0.0, 0.3),
        "t": Phone((3200, 4200, 5200), 0.04, 0.0, 0.5),
        "_": Phone((300, 1200, 2400), 0.04, 0.0),  # a closed mouth
    }
)

WORDS = MappingProxyType(
    {
        "robot": "r o _ b o _ t",
        "stop": "s _ t a _ p",
        "dance": "d a n s",
        "wave": "u e i v",
        "disco": "d i s _ k o",
        "waltz": "u o l _ t s",
        "walk": "u a o _ k",
        "home": "h o u m",
    }
)
"""What the voice can say: words and their sounds."""

_BANDWIDTHS = (80.0, 110.0, 160.0)  # Hz of the formants
_HIGHEST = 7000.0  # Hz
_LOUD = 9000  # of 32767


def say(
    words: Sequence[str] | str, *, pitch: float = 120.0, speed: float = 1.0, loud: float = 1.0, seed: int = 0
) -> NDArray[np.int16]:
    """The sound of words, at RATE, with a pause between two. Raises ValueError for a word it cannot say."""
    random = np.random.default_rng(seed)
    pause = np.zeros(round(PAUSE * RATE))
    parts: list[Array] = [pause]
    for word in words.split() if isinstance(words, str) else words:
        if word not in WORDS:
            raise ValueError(f"the voice cannot say '{word}': it knows {', '.join(WORDS)}")
        parts += [_spoken(WORDS[word].split(), pitch, speed, random), pause]
    sound = np.concatenate(parts)
    return np.clip(sound * _LOUD * loud, -32768, 32767).astype(np.int16)


def _spoken(names: Sequence[str], pitch: float, speed: float, random: np.random.Generator) -> Array:
    """One word: harmonics and noise through formants that glide from sound to sound."""
    phones = [_PHONES[name] for name in names]
    ends = np.cumsum([phone.seconds / speed for phone in phones])
    time = np.arange(int(ends[-1] * RATE)) / RATE
    middles = ends - np.array([phone.seconds / speed / 2 for phone in phones])
    formants = np.array([np.interp(time, middles, [p.formants[n] for p in phones]) for n in range(3)])
    which = np.minimum(np.searchsorted(ends, time), len(phones) - 1)
    voice, noise = (
        _smooth(np.array([getattr(phone, kind) for phone in phones])[which]) for kind in ("voice", "noise")
    )
    melody = pitch * (1.05 - 0.1 * time / time[-1])
    phase = 2 * np.pi * np.cumsum(melody) / RATE
    sound = np.zeros_like(time)
    for harmonic in range(1, int(_HIGHEST / pitch) + 1):
        loudness = _through(formants, harmonic * melody)
        sound += loudness * np.sin(harmonic * phase) / harmonic**0.5
    hiss = np.zeros_like(time)
    for frequency in np.arange(500.0, _HIGHEST, 80.0):
        hiss += _through(formants, np.full_like(time, frequency)) * np.sin(
            2 * np.pi * (frequency * time + random.random())
            + random.standard_normal(len(time)).cumsum() * 0.15
        )
    whole: Array = voice * sound / 6 + noise * hiss / 6
    return whole


def _through(formants: Array, frequency: Array) -> Array:
    """How much formants (3, n) let through of frequencies (n,)."""
    total = np.zeros_like(frequency)
    for number, (place, width) in enumerate(zip(formants, _BANDWIDTHS, strict=True)):
        total += 0.7**number / (1.0 + ((frequency - place) / width) ** 2)
    return total


def _smooth(values: Array, seconds: float = 0.012) -> Array:
    """Values without jumps."""
    size = max(1, int(seconds * RATE))
    padded = np.pad(values, size // 2, mode="edge")
    smooth: Array = np.convolve(padded, np.ones(size) / size, mode="same")[
        size // 2 : size // 2 + len(values)
    ]
    return smooth
