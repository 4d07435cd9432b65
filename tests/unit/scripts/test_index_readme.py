"""README.md on a package index: links lead to the tag of the release, or are text."""

import re

import index_readme
import pytest

LINK = re.compile(r"\]\(([^)]*)\)")
ADDRESSES = (
    "git@github.com:owner/name.git",
    "https://a-token@github.com/owner/name",
    "ssh://git@github.com/owner/name.git",
    "/a/folder",
    "https://github.com.example.org/owner/name",
    "",
)


@pytest.mark.parametrize("address", ADDRESSES)
def test_no_link_of_the_readme_is_relative(address):
    text = index_readme.README.read_text("utf-8")
    page = index_readme.readable(text, "v1.2.0", address)
    known = "github.com/" in address or "github.com:" in address
    assert len(LINK.findall(page)) == (len(LINK.findall(text)) if known else 0)
    assert all(link.startswith("https://github.com/owner/name/") for link in LINK.findall(page))
    assert (index_readme.PLACEHOLDER in page) is not known
    assert "a-token" not in page


def test_pictures_are_files_and_links_are_pages():
    text = (
        "![a picture](a.png)\n\n[a page](b.md#c) and\n[two\nlines](d.md), [far](https://e.org), [here](#f)\n"
    )
    page = index_readme.readable(text, "v1", "https://github.com/o/n.git")
    assert "![a picture](https://github.com/o/n/raw/v1/a.png)" in page
    assert "[a page](https://github.com/o/n/blob/v1/b.md#c) and" in page
    assert "[two\nlines](https://github.com/o/n/blob/v1/d.md), [far](https://e.org), [here](#f)" in page


def test_without_an_address_text_stays_and_what_begins_with_a_link_goes():
    text = "![a picture](a.png)\n\n[Hear it](a.wav).\n\nSee [this](b.md) and [far](https://e.org).\n"
    assert index_readme.readable(text, "v1", "").split("\n\n") == ["", "See this and [far](https://e.org).\n"]
