"""`python -m ifgen` is `ifgen`."""

import sys

from ifgen.cli import main

sys.exit(main())
