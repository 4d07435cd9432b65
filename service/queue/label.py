"""The label of a job: what its caller calls it, and what it is found by."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any, Self

from sqlalchemy import ColumnElement

from service.queue.tables import jobs


@dataclass(frozen=True)
class Label:
    """Title and tags of a job; they say nothing about the work.

    Attributes
    ----------
    title : str
    tags : tuple[str, ...]
        In lower case, each once.
    """

    title: str = ""
    tags: tuple[str, ...] = ()

    @classmethod
    def of(cls, title: str, tags: Iterable[str]) -> Self:
        """Return the label that a caller writes: without outer spaces, tags in lower case and each once."""
        return cls(title.strip(), tuple(dict.fromkeys(tag.lower() for tag in tags)))

    @classmethod
    def from_row(cls, row: Any) -> Self:
        """Return the label of a row of the job table."""
        return cls(row.title, tuple(row.tags.split()))

    def columns(self) -> dict[str, str]:
        """Return it as the job table has it: the title also as it is searched, tags one a line."""
        lines = "".join(f"{tag}\n" for tag in self.tags)
        return {"title": self.title, "title_folded": self.title.casefold(), "tags": f"\n{lines}"}


NO_LABEL = Label()


def labeled(tags: Iterable[str], words: Iterable[str]) -> list[ColumnElement[bool]]:
    """Return the conditions of jobs that have all of these tags, and all of these words in their title."""
    of_tags = [jobs.c.tags.contains(f"\n{tag.lower()}\n", autoescape=True) for tag in tags]
    of_words = [jobs.c.title_folded.contains(word.casefold(), autoescape=True) for word in words]
    return [*of_tags, *of_words]
