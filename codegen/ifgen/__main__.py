"""`python -m ifgen` is `ifgen`."""

from ifgen.cli import main

main()
