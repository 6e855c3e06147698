"""What a package.xml says about a package besides its name."""

from __future__ import annotations

from pathlib import Path
from xml.etree import ElementTree

from ifgen.nodl.model import PackageMetadata


def read_metadata(root: Path) -> PackageMetadata | None:
    """What the package.xml in a folder says; None if there is none that can be read (read.py says why)."""
    try:
        document = ElementTree.fromstring((root / "package.xml").read_bytes())
    except (OSError, ElementTree.ParseError):
        return None

    def text(tag: str) -> str:
        element = document.find(tag)
        return " ".join("".join(element.itertext()).split()) if element is not None else ""

    maintainer = document.find("maintainer")
    email = maintainer.get("email", "") if maintainer is not None else ""
    return PackageMetadata(
        text("version"), text("description"), text("maintainer"), email.strip(), text("license")
    )
