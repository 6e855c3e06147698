"""Words in sound: the voice that says them, and the spotter that hears them."""

from __future__ import annotations

import numpy as np
import pytest
from humanoid.sensing import voice
from humanoid.sensing.hearing import Listener, WordSpotter, cepstra, distance, understood, words_in

RANDOM = np.random.default_rng(1)


@pytest.fixture(scope="module")
def spotter() -> WordSpotter:
    return WordSpotter()


def spoken(word: str, seed: int) -> np.ndarray:
    """A word as somebody else says it, in a room that is not quiet."""
    random = np.random.default_rng(seed)
    sound = voice.say(
        word,
        pitch=random.uniform(90, 210),
        speed=random.uniform(0.85, 1.2),
        loud=random.uniform(0.5, 1.3),
        seed=seed,
    )
    return np.clip(sound + random.normal(0, 40, len(sound)), -32768, 32767).astype(np.int16)


@pytest.mark.parametrize("word", voice.WORDS)
def test_each_word_is_heard_whoever_says_it(spotter: WordSpotter, word: str) -> None:
    heard = [spotter.word(part)[0] for seed in range(5) for part in words_in(spoken(word, seed))]
    assert heard == [word] * 5


def test_other_sounds_are_no_words(spotter: WordSpotter) -> None:
    time = np.arange(8000) / voice.RATE
    tone = (8000 * np.sin(2 * np.pi * 440 * time)).astype(np.int16)
    for sound in (RANDOM.normal(0, 3000, 8000).astype(np.int16), tone):
        assert spotter.word(sound)[0] == ""


def test_an_utterance_ends_with_silence() -> None:
    listener = Listener(silence=0.5)
    quiet = np.zeros(voice.RATE, dtype=np.int16)
    sound = np.concatenate([quiet, voice.say("robot walk home", pitch=140.0), quiet, quiet])
    heard = [listener.hear(sound[start : start + 320]) for start in range(0, len(sound), 320)]
    assert [words for words in heard if words is not None] == ["robot walk home"]
    assert listener.hear(quiet[:0]) is None


def test_what_is_asked_for() -> None:
    assert understood("Robot dance wave", "robot") == "dance wave"
    assert understood("dance wave", "robot") == ""
    assert understood("robot ? wave", "robot") == ""
    assert understood("dance wave") == "dance wave"
    assert understood("", "robot") == understood("") == ""


def test_distances_are_small_for_the_same_and_large_for_other_words() -> None:
    one, same, other = (
        cepstra(voice.say(word, pitch=pitch)) for word, pitch in (("stop", 110), ("stop", 150), ("home", 110))
    )
    assert distance(one, one) == 0.0
    assert distance(one, same) < 0.7 * distance(one, other)


def test_the_voice_has_few_words() -> None:
    with pytest.raises(ValueError, match="the voice cannot say 'fly': it knows robot, stop"):
        voice.say("robot fly")
