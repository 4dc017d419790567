"""Hooks of the site (mkdocs.yml). Pages of docs/ are written for readers of the repository, too; of a site they need three things more:

- every decision and every page of measurements has its place in the navigation;
- a link to a file outside docs/ leads to a copy of that file, in the site's folder `source`;
- a picture of images/gallery leads to the page that it is a picture of, in the folder BRIO_GALLERY (scripts/site.sh)."""

import os
import pathlib
import re

from mkdocs.structure.files import File

ROOT = pathlib.Path(__file__).resolve().parents[1]
DOCS = ROOT / "docs"
LINK = re.compile(r"(?<=\]\()([^)#:\s]+)")
PICTURE = re.compile(r"!\[[^\]]*\]\(((?:\.\./)?)images/gallery/([\w-]+)\.jpg\)")


def on_config(config):
    for title, folder in (("Measured", "measured"), ("Decisions", "decisions")):
        config["nav"].append({title: sorted("%s/%s" % (folder, page.name) for page in (DOCS / folder).glob("*.md"))})


def source(page, link):
    """The file outside docs/ that a page links to, or None."""
    target = (DOCS / page).parent.joinpath(link).resolve()
    if DOCS in target.parents or not target.is_relative_to(ROOT) or not target.exists():
        return None
    return next(target.glob("README.md"), target / "CMakeLists.txt") if target.is_dir() else target


def copy_of(target):
    return "source/%s.txt" % target.relative_to(ROOT)


def on_files(files, config):
    for page in files.documentation_pages():
        for link in LINK.findall(page.content_string):
            target = source(page.src_uri, link)
            if target and not files.get_file_from_path(copy_of(target)):
                files.append(File.generated(config, copy_of(target), content=target.read_bytes()))
    for page in pathlib.Path(os.environ["BRIO_GALLERY"]).glob("*.html"):
        files.append(File.generated(config, "gallery/" + page.name, abs_src_path=str(page)))


def on_page_markdown(markdown, page, config, files):
    up = "../" * page.file.src_uri.count("/")

    def to_copy(found):
        target = source(page.file.src_uri, found[1])
        return up + copy_of(target) if target else found[1]

    markdown = LINK.sub(to_copy, markdown)
    return PICTURE.sub(lambda found: "[%s](%sgallery/%s.html)" % (found[0], found[1], found[2]), markdown)
