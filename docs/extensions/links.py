"""Check the links of a built site: every local target exists, and nothing is loaded from a network.

python docs/extensions/links.py SITE
"""

import sys
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

_LOADED = {"img", "link", "script", "iframe", "source"}  # fetched to show a page, not followed


class _Page(HTMLParser):
    """Targets that a page links to or loads, and the anchors that it has."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.links: set[tuple[str, str]] = set()
        self.anchors: set[str] = set()
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Keep ``href``, ``src`` and ``id``."""
        for name, value in attrs:
            if name in ("href", "src") and value:
                self.links.add((tag, value))
            elif name == "id" and value:
                self.anchors.add(value)


def faults_of(site: Path) -> list[str]:
    """Return a line for each link that leads nowhere, or that loads from a network."""
    pages = {
        path.resolve(): _Page(path.read_text(encoding="utf-8")) for path in site.rglob("*.html")
    }
    faults = []
    for path, page in sorted(pages.items()):
        for tag, link in sorted(page.links):
            parts = urlsplit(link)
            if parts.scheme == "data":
                continue
            if parts.scheme or parts.netloc:
                if tag in _LOADED:
                    faults.append(f"{path}: loads {link}")
                continue
            target = (path.parent / unquote(parts.path)).resolve() if parts.path else path
            if not target.is_file():
                faults.append(f"{path}: no file {link}")
            elif parts.fragment and target in pages:
                anchor = unquote(parts.fragment)
                if anchor not in pages[target].anchors:
                    faults.append(f"{path}: no anchor {link}")
    return faults if pages else [f"{site}: no pages"]


if __name__ == "__main__":
    found = faults_of(Path(sys.argv[1]))
    sys.exit("\n".join(found) if found else None)
