"""Hook of the build: the README as an index of packages shows it.

An index has neither the pictures nor the pages beside the README; the source distribution has both.
"""

import re
from pathlib import Path
from typing import Any

from hatchling.metadata.plugin.interface import MetadataHookInterface

_ELSEWHERE = r"\((?!https?:)[^)]*\)"
_NOTE = "\nThe pictures, pages and files named here are in the source distribution.\n"


class IndexReadme(MetadataHookInterface):
    """Take pictures out of the README, and leave the words of links that lead into the checkout."""

    def update(self, metadata: dict[str, Any]) -> None:
        """Set ``readme``."""
        text = Path(self.root, "README.md").read_text(encoding="utf-8")
        text = re.sub(rf"!\[[^\]]*\]{_ELSEWHERE}\n*", "", text)
        text = re.sub(rf"\[([^\]]*)\]{_ELSEWHERE}", r"\1", text)
        metadata["readme"] = {"content-type": "text/markdown", "text": text + _NOTE}
