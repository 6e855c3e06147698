"""Damaged recordings: every one of them is a BagError, or fewer messages.

    python -m tests.bags.fuzzing FOLDER [CASES]

A case is a number. Its seed chooses one of the sound bags and what happens to its bytes.
"""

from __future__ import annotations

import random
import sys
import time
import warnings
from pathlib import Path

from ifgen_runtime.bag import Bag, BagError

INTERESTING = (0, 1, 2, 0x7F, 0x80, 0xFF, 0xFFFF, 2**31 - 1, 2**32 - 1, 2**40, 2**63, 2**64 - 1)


def damaged(data: bytes, chance: random.Random) -> bytes:
    """The bytes with one to three kinds of damage."""
    changed = bytearray(data)
    for _ in range(chance.randint(1, 3)):
        place = chance.randrange(len(changed) or 1)
        kind = chance.randrange(7)
        if kind == 0 and changed:
            changed[place] ^= 1 << chance.randrange(8)
        elif kind == 1:
            size = chance.choice((1, 2, 4, 8))
            number = chance.choice(INTERESTING) % 256**size
            changed[place : place + size] = number.to_bytes(size, "little")
        elif kind == 2:
            del changed[place:]
        elif kind == 3:
            del changed[place : place + chance.randrange(1, 64)]
        elif kind == 4:
            changed[place:place] = changed[: chance.randrange(1, 64)]
        elif kind == 5:
            other = chance.randrange(len(changed) or 1)
            changed[place : place + 32] = changed[other : other + 32]
        else:
            changed[place : place + 16] = chance.randbytes(16)
    return bytes(changed)


def read(path: Path) -> int:
    """Read all of a bag in each way. Returns how many messages there were; -1 for a BagError."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            with Bag(path) as bag:
                count = sum(len(recorded.data) >= 0 for recorded in bag)
                for topic in list(bag.topics)[:8]:
                    try:
                        for _ in bag[topic]:
                            pass
                    except BagError:  # no class, say
                        pass
                return count
        except BagError:
            return -1


def run(sound: list[Path], folder: Path, cases: range) -> tuple[int, float]:
    """Try cases. Returns how many of them could still be read, and the longest time [s]."""
    readable, longest = 0, 0.0
    for case in cases:
        chance = random.Random(case)
        path = chance.choice(sound)
        changed = folder / f"case{path.suffix}"
        changed.write_bytes(damaged(path.read_bytes(), chance))
        begin = time.perf_counter()
        try:
            readable += read(changed) >= 0
        except BaseException as error:
            error.add_note(f"case {case}, made of {path}")
            raise
        longest = max(longest, time.perf_counter() - begin)
    return readable, longest


if __name__ == "__main__":
    folder = Path(sys.argv[1])
    bags = sorted(
        path for path in folder.iterdir() if path.suffix in (".mcap", ".db3") and path.stem != "case"
    )
    print(run(bags, folder, range(int(sys.argv[2]))))
