"""Make README.md readable on a package index, where links to files of the repository lead nowhere.

Usage: index_readme.py TAG ADDRESS   such as v1.2.0 git@github.com:owner/name.git
Where the address is one of GitHub, links lead to the files of the tag there. Else the text of a link stays,
and pictures and paragraphs that begin with a link are left out.
"""

from __future__ import annotations

import re
import sys
from pathlib import Path

README = Path(__file__).resolve().parents[1] / "README.md"
PLACEHOLDER = "ADDRESS_OF_THIS_REPOSITORY"
_GITHUB = re.compile(r"(?:^|[/@])github\.com[/:]([\w.-]+/[\w.-]+?)(?:\.git)?/?$")
_LINK = re.compile(r"(!?)\[([^]]*)\]\((?!\w+:|#)([^)\s]+)\)")
"""A link or a picture by a relative path: mark of a picture, text, target."""


def readable(text: str, tag: str, address: str) -> str:
    """Return a page without relative links; nothing else of an address than owner and name is written."""
    github = _GITHUB.search(address)
    if github is None:
        paragraphs = text.split("\n\n")
        kept = (part for part in paragraphs if not re.match(r"\[[^]]*\]\((?!\w+:)", part))
        return _LINK.sub(lambda link: "" if link[1] else link[2], "\n\n".join(kept))
    place = f"https://github.com/{github[1]}"
    folder = {"": f"{place}/blob/{tag}", "!": f"{place}/raw/{tag}"}
    linked = _LINK.sub(lambda link: f"{link[1]}[{link[2]}]({folder[link[1]]}/{link[3]})", text)
    return linked.replace(PLACEHOLDER, place)


if __name__ == "__main__":
    README.write_text(readable(README.read_text("utf-8"), *sys.argv[1:3]), "utf-8")
