"""`python -m tests.codec.fuzzing`."""

import sys

from .runs import main

if __name__ == "__main__":  # not in the processes that it starts
    sys.exit(main())
