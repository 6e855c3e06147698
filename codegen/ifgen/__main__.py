"""`python -m ifgen` is `ifgen`."""

import sys

from ifgen.cli.main import main

sys.exit(main())
