"""Random numbers that repeat: one generator per node, all from one seed."""

from __future__ import annotations

import zlib

import numpy as np


def generator(seed: int, node: str) -> np.random.Generator:
    """The generator of one node; it depends only on seed and name, not on which other nodes exist."""
    return np.random.default_rng(np.random.SeedSequence(entropy=seed, spawn_key=(zlib.crc32(node.encode()),)))
