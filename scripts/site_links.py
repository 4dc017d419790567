"""site_links.py SITE: every link and picture of the site's pages is there; exit status 1, with the list, if one is not.

MkDocs looks at links between its pages; this looks at what was written, the manual of C and files that were left out included."""

import html.parser
import pathlib
import sys
import urllib.parse


class Links(html.parser.HTMLParser):
    def __init__(self, text):
        super().__init__()
        self.found = []
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        self.found += [value for name, value in attributes if name in ("href", "src") and value]


def dead(site):
    """Yields (page, link); pages of the gallery are brio's own, which ask for nothing."""
    for page in sorted(site.rglob("*.html")):
        if page.parent == site / "gallery" or page.name == "404.html":
            continue
        for link in set(Links(page.read_text(encoding="utf-8", errors="replace")).found):
            parts = urllib.parse.urlsplit(link)
            if not parts.scheme and not parts.netloc and parts.path and not (page.parent / urllib.parse.unquote(parts.path)).exists():
                yield page.relative_to(site), link


if __name__ == "__main__":
    missing = list(dead(pathlib.Path(sys.argv[1])))
    for place, target in missing:
        print("%s: there is no %s" % (place, target))
    sys.exit(1 if missing else 0)
