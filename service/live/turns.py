"""Turns of questions that wait for an answer: each access key has a line.

With its own line, a caller that floods the service waits only behind itself. A slider of a page, which sends
a question at each move, has one place in its line. A newer question of the slider replaces the one that
waits. It also stops the one that is being answered, unless the newer question profits from that work.
"""

from __future__ import annotations

import itertools
import math
from collections import Counter, OrderedDict
from collections.abc import Callable, Iterator
from concurrent.futures import Future
from dataclasses import dataclass, field

from lineofaction.gearbox.problems import QueueFull, Superseded, TooManyHeld
from service.access.capacity import KEYLESS
from service.live.order import LiveOrder

_RETRY_S = 1


@dataclass(frozen=True)
class Asker:
    """The sender of a question."""

    key: str = KEYLESS
    """Name of the access key."""
    slider: str | None = None
    """Name of a slider, of whose questions only the newest counts. Keys do not share names."""
    submits: bool = False
    """Whether a submission waits for the answer. Such a question has a line of its own, before all others."""


@dataclass
class Question:
    """A question, and the future of its JSON answer or its error."""

    order: LiveOrder
    asker: Asker = Asker()
    subject: str = ""
    """Subject of the question. A worker that has answered a question on the same subject still has it in
    memory."""
    lasting: bool = False
    """Whether later questions about the subject profit from the work, which is then not stopped for them."""
    answer: Future[bytes] = field(default_factory=Future)
    obsolete: bool = False
    """Whether the same slider has sent a newer question."""

    def refuse(self, error: Exception) -> None:
        """End the question with an error, if nobody answers it."""
        if self.answer.set_running_or_notify_cancel():
            self.answer.set_exception(error)


@dataclass(frozen=True)
class Limits:
    """Largest numbers of questions of one key and of all keys.

    In a service without keys only `in_all` limits the callers.
    """

    answered: int = 1
    """Most questions of a key that are answered at the same time."""
    outstanding: int = 2
    """Most questions of a key, answered and waiting."""
    submissions: int = 8
    """Most questions of a key for which submissions wait, answered and waiting."""
    in_all: int = 20
    """Most questions of all keys, answered and waiting."""


@dataclass(frozen=True)
class _Line:
    """Name of a line; lines of submissions come first."""

    submits: bool
    key: str


class Turns:
    """Questions that wait or are being answered. It is not safe for threads: its user must hold a lock.

    Parameters
    ----------
    limits : Limits
    what : str
        Plural noun for the waiting questions in a refusal.
    """

    def __init__(self, limits: Limits, what: str) -> None:
        self._limits, self._what = limits, what
        self._lines: OrderedDict[_Line, OrderedDict[str, Question]] = OrderedDict()
        self._answered: dict[int, Question] = {}
        self._number = itertools.count()

    def enter(self, question: Question) -> None:
        """Let a question wait, in the place of an older one of its slider.

        Raises
        ------
        TooManyHeld
            The key has its largest number of questions.
        QueueFull
            All keys together have their largest number.
        """
        line, slider = _line_of(question), question.asker.slider
        name = (
            f"#{next(self._number)}" if slider is None else f" {slider}"
        )  # a slider cannot have a number's name
        waiting = self._lines.get(line, OrderedDict())
        if name in waiting:
            older, waiting[name] = (
                waiting[name],
                question,
            )  # in the same turn, or a slider in motion never has one
            older.refuse(Superseded("A later request of the same caller replaced it."))
        else:
            self._refuse_beyond(line)
            self._lines.setdefault(line, waiting)[name] = question
        self._make_obsolete(question)

    def next(self, fits: Callable[[Question], bool] = lambda _: True) -> Question | None:
        """Return the question whose turn it is among those that fit; it is in progress from now on."""
        busy = self._busy()
        for line in sorted(self._lines, key=lambda line: not line.submits):
            name, question = next(iter(self._lines[line].items()))
            maximum = math.inf if line.key == KEYLESS else self._limits.answered
            if busy[line] < maximum and fits(question):
                self._take(line, name)
                self._answered[id(question)] = question
                return question
        return None

    def ended(self, question: Question) -> None:
        """Note that a question has its answer."""
        del self._answered[id(question)]

    def empty(self) -> Iterator[Question]:
        """Remove all waiting questions and yield them."""
        while self._lines:
            _, waiting = self._lines.popitem()
            yield from waiting.values()

    def _take(self, line: _Line, name: str) -> None:
        """Remove a question from its line, and put the line behind all others."""
        del self._lines[line][name]
        self._lines.move_to_end(line)
        if not self._lines[line]:
            del self._lines[line]

    def _busy(self) -> Counter[_Line]:
        """Return the number of questions of each line that are being answered."""
        return Counter(map(_line_of, self._answered.values()))

    def _refuse_beyond(self, line: _Line) -> None:
        maximum = self._limits.submissions if line.submits else self._limits.outstanding
        count = self._busy()[line] + len(self._lines.get(line, ()))
        if line.key != KEYLESS and count >= maximum:
            text = f"Key {line.key!r} has {maximum} {self._what} in work and waiting. Try again soon."
            raise TooManyHeld.after(_RETRY_S, text)
        if sum(map(len, self._lines.values())) + len(self._answered) >= self._limits.in_all:
            text = f"{self._limits.in_all} {self._what} are in work and waiting. Try again soon."
            raise QueueFull.after(_RETRY_S, text)

    def _make_obsolete(self, newer: Question) -> None:
        for question in self._answered.values():
            helps_newer = question.lasting and question.subject == newer.subject
            if newer.asker.slider is not None and question.asker == newer.asker and not helps_newer:
                question.obsolete = True


def _line_of(question: Question) -> _Line:
    return _Line(question.asker.submits, question.asker.key)
