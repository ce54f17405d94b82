"""README for a package index: pictures and links lead to the source's address, and are left out where there is none.

An index shows the text without the files beside it, so that a relative link leads nowhere there. The address is
``Source`` under ``[project.urls]`` in ``pyproject.toml``.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

from hatchling.metadata.plugin.interface import MetadataHookInterface

_PICTURE = re.compile(r"^!\[([^\]]*)\]\((?!https?:)([^)]+)\)\n", re.M)
_LINK = re.compile(r"\[([^\]]*)\]\((?!https?:)([^)]+)\)")


def described(text: str, source: str | None) -> str:
    """Give the README as an index can show it.

    Parameters
    ----------
    text : str
        Markdown with links relative to the project's folder.
    source : str or None
        Address of the source, without a slash at its end.

    Returns
    -------
    str
    """
    if source is None:
        return _LINK.sub(r"\1", _PICTURE.sub("", text))
    return _LINK.sub(rf"[\1]({source}/blob/HEAD/\2)", _PICTURE.sub(rf"![\1]({source}/raw/HEAD/\2)\n", text))


class ReadmeHook(MetadataHookInterface):
    """Put the README into the metadata."""

    PLUGIN_NAME = "custom"

    def update(self, metadata: dict[str, Any]) -> None:
        """Set ``readme``."""
        text = (Path(self.root) / "README.md").read_text(encoding="utf-8")
        source = metadata.get("urls", {}).get("Source")
        metadata["readme"] = {"content-type": "text/markdown", "text": described(text, source)}
