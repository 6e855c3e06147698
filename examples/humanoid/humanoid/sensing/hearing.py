"""Spots words in sound: cepstra of short frames, compared with patterns by dynamic time warping.

The patterns are words as `voice.py` says them, so it understands that voice, at other pitches and speeds, and
with noise. It is no recognition of human speech.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from ..spatial import Array
from . import voice

Sound = NDArray[np.int16]

_FRAME, _HOP = 0.025, 0.010  # s
_FLOOR = 1e7  # energy of a band that does not count: the noise of a room
_BANDS, _CEPSTRA = 24, 12
_LOWEST, _HIGHEST = 120.0, 7000.0  # Hz
_QUIET = 120.0  # root mean square of a sample below which nobody speaks
_LOUDER = 3.0  # times the background
_BETWEEN = 0.12  # s of silence between two words; shorter ones are closed lips
_SHORTEST = 0.10  # s of a word
_LONGEST = 10.0  # s of an utterance
_UNLIKE = 0.24  # distance per frame from which a sound is none of the words
_PATTERNS = ((95.0, 1.0), (130.0, 1.0), (190.0, 1.0))  # pitch [Hz] and speed of the patterns of a word


def cepstra(sound: Sound | Array, rate: int = voice.RATE) -> Array:
    """The shape of the spectrum of each frame, (frames, cepstra), without the mean over all frames."""
    frames = _frames(np.asarray(sound, dtype=float), rate)
    size = frames.shape[1]
    spectrum = np.abs(np.fft.rfft(frames * np.hamming(size), axis=1)) ** 2
    bands = np.log(spectrum @ _filters(size, rate).T + _FLOOR)
    number, order = np.arange(_BANDS) + 0.5, np.arange(1, _CEPSTRA + 1)[:, None]
    shapes = bands @ np.cos(np.pi * order * number / _BANDS).T / _BANDS
    centred: Array = shapes - shapes.mean(axis=0)
    return centred


def distance(one: Array, other: Array) -> float:
    """How different two words are: the mean distance of frames on the best way through both."""
    apart = np.sqrt(((one[:, None, :] - other[None, :, :]) ** 2).sum(axis=2))
    cost = np.full((len(one) + 1, len(other) + 1), math.inf)
    cost[0, 0] = 0.0
    for row in range(1, len(one) + 1):
        above, here = cost[row - 1], cost[row]
        for column in range(1, len(other) + 1):
            here[column] = apart[row - 1, column - 1] + min(
                above[column], above[column - 1], here[column - 1]
            )
    return float(cost[-1, -1]) / (len(one) + len(other))


class WordSpotter:
    """Names the word in a sound."""

    def __init__(self, words: Sequence[str] = tuple(voice.WORDS), rate: int = voice.RATE) -> None:
        self._rate = rate
        self._patterns: Mapping[str, list[Array]] = {
            word: [
                cepstra(words_in(voice.say(word, pitch=pitch, speed=speed))[0]) for pitch, speed in _PATTERNS
            ]
            for word in words
        }

    def word(self, sound: Sound) -> tuple[str, float]:
        """The most similar word and its distance; "" if none is similar."""
        heard = cepstra(sound, self._rate)
        found = {
            word: min(distance(heard, pattern) for pattern in patterns)
            for word, patterns in self._patterns.items()
        }
        best = min(found, key=found.__getitem__)
        return (best if found[best] < _UNLIKE else ""), found[best]


class Listener:
    """Collects blocks of sound until somebody has finished speaking, and spots the words in that."""

    def __init__(self, rate: int = voice.RATE, silence: float = 0.8) -> None:
        """Set up; an utterance ends with `silence` [s]."""
        self._rate, self._silence = rate, silence
        self._spotter = WordSpotter(rate=rate)
        self._blocks: list[Sound] = []
        self._quiet = 0.0  # s since somebody spoke
        self._background = _QUIET

    def hear(self, block: Sound) -> str | None:
        """Take the next block; returns the words of an utterance when it is over, `?` for unknown ones."""
        if not len(block):
            return None
        loud = math.sqrt(float(np.mean(np.square(block.astype(float)))))
        speaks = loud > max(_QUIET, _LOUDER * self._background)
        seconds = len(block) / self._rate
        if not self._blocks and not speaks:
            self._background += 0.1 * (loud - self._background)
            return None
        self._blocks.append(block)
        self._quiet = 0.0 if speaks else self._quiet + seconds
        if self._quiet < self._silence and len(self._blocks) * seconds < _LONGEST:
            return None
        sound = np.concatenate(self._blocks)
        self.forget()
        background = max(_QUIET, _LOUDER * self._background)
        words = [self._spotter.word(part)[0] or "?" for part in words_in(sound, self._rate, background)]
        return " ".join(words) or None

    def forget(self) -> None:
        """Forget what was said so far."""
        self._blocks, self._quiet = [], 0.0


def words_in(sound: Sound, rate: int = voice.RATE, quiet: float = _QUIET) -> list[Sound]:
    """The parts of a sound with a word each, cut where there is silence."""
    loud = np.sqrt(np.mean(np.square(_frames(sound.astype(float), rate)), axis=1)) > quiet
    hop, between = round(_HOP * rate), round(_BETWEEN / _HOP)
    parts: list[Sound] = []
    speaking = np.nonzero(loud)[0]
    if not len(speaking):
        return parts
    for part in np.split(speaking, np.nonzero(np.diff(speaking) > between)[0] + 1):
        start, end = part[0] * hop, part[-1] * hop + round(_FRAME * rate)
        if end - start >= _SHORTEST * rate:
            parts.append(sound[start:end])
    return parts


def understood(words: str, hot_word: str = "") -> str:
    """What was asked for: without the hot word; "" if that is missing, or a word was not understood."""
    first, *rest = words.lower().split() or [""]
    asked = rest if hot_word and first == hot_word else [first, *rest]
    if (hot_word and first != hot_word) or "?" in asked:
        return ""
    return " ".join(asked)


def _frames(sound: Array, rate: int) -> Array:
    """Overlapping frames (n, samples)."""
    size, hop = round(_FRAME * rate), round(_HOP * rate)
    if len(sound) < size:
        sound = np.pad(sound, (0, size - len(sound)))
    return np.lib.stride_tricks.sliding_window_view(sound, size)[::hop]


def _filters(size: int, rate: int) -> Array:
    """Triangular bands (bands, frequencies), narrow where the ear is fine."""
    lowest, highest = (2595 * math.log10(1 + f / 700) for f in (_LOWEST, min(_HIGHEST, rate * 0.45)))
    corners = 700 * (10 ** (np.linspace(lowest, highest, _BANDS + 2) / 2595) - 1)
    frequencies = np.fft.rfftfreq(size, 1 / rate)[None, :]
    left, middle, right = corners[:-2, None], corners[1:-1, None], corners[2:, None]
    bands: Array = np.clip(
        np.minimum((frequencies - left) / (middle - left), (right - frequencies) / (right - middle)), 0, None
    )
    return bands
