"""The pool that answers questions while their callers wait: some workers, and whose turn it is.

A worker starts when a question comes and no other worker is free, and ends after a while without questions. A
question goes to the worker that has its subject in memory, if that worker is free.
"""

from __future__ import annotations

import threading
from collections import OrderedDict
from collections.abc import Sequence
from concurrent.futures import Future
from typing import Protocol

from lineofaction.gearbox.problems import LiveUnavailable
from service.live.order import LiveOrder
from service.live.turns import Asker, Limits, Question, Turns

STOP = "The service stops."
"""Refusal of a question that comes after a stop, or was in progress then."""
_SUBJECTS = 64
"""Most subjects of which the pool remembers the worker."""


class QuestionWorker(Protocol):
    """Answers one question after the other, in a process other than the service's."""

    def answer(self, question: Question) -> bytes:
        """Return the JSON answer; raises `ServiceError`, or `Superseded` if the question became obsolete."""

    def rest(self) -> None:
        """Free the memory while no questions come; the next question starts the process again."""

    def start(self) -> None:
        """Answer questions again after a stop; the next question starts the processes."""

    def stop(self) -> None:
        """End the question in progress, whose caller gets the error of a stop, and start no process more.

        Any thread may call this.
        """

    def close(self) -> None:
        """End all processes, once no question is in progress after a stop."""


class QuestionPool:
    """Passes questions to workers, in turn by key.

    Parameters
    ----------
    workers : sequence of QuestionWorker
    limits : Limits
    what : str
        Plural noun for the questions in refusals.
    for_submissions : int
        Number of workers, the first ones, that answer only questions of waiting submissions.
    idle_s : float
        Time without a question after which a worker ends.
    """

    def __init__(
        self,
        workers: Sequence[QuestionWorker],
        limits: Limits,
        what: str,
        *,
        for_submissions: int = 0,
        idle_s: float = 600.0,
    ) -> None:
        self._workers, self._turns = workers, Turns(limits, what)
        self._for_submissions, self._idle_s = for_submissions, idle_s
        self._changed = threading.Condition()
        self._threads: dict[int, threading.Thread] = {}
        self._idle: set[int] = set()
        self._worker_of: OrderedDict[str, int] = OrderedDict()
        self._stopping = False

    def ask(
        self, order: LiveOrder, asker: Asker | None = None, *, subject: str = "", lasting: bool = False
    ) -> Future[bytes]:
        """Enter a question; the future holds the bytes of its JSON answer, or the error.

        Parameters are those of `Question`. Raises `TooManyHeld` and `QueueFull`: see `Turns.enter`;
        `LiveUnavailable`: the service stops.
        """
        question = Question(order, asker or Asker(), subject, lasting)
        with self._changed:
            if self._stopping:
                raise LiveUnavailable(STOP)
            self._turns.enter(question)
            self._begin_worker(question)
            self._changed.notify_all()
        return question.answer

    def start(self) -> None:
        """Take questions again after a stop."""
        with self._changed:
            for worker in self._workers:
                worker.start()
            self._stopping = False

    def stop(self) -> None:
        """Refuse the waiting questions and all later ones, and end the workers."""
        with self._changed:
            self._stopping = True
            for question in self._turns.empty():
                question.refuse(LiveUnavailable(STOP))
            threads = list(self._threads.values())
            self._changed.notify_all()
        for worker in self._workers:
            worker.stop()
        for thread in threads:
            thread.join()
        for worker in self._workers:
            worker.close()

    def _begin_worker(self, question: Question) -> None:
        """Start a worker if no idle worker serves the question."""
        fitting = [i for i in range(len(self._workers)) if self._serves(i, question)]
        if self._idle.isdisjoint(fitting):
            for number in fitting:
                if number not in self._threads:
                    thread = threading.Thread(target=self._loop, args=(number,), daemon=True)
                    self._threads[number] = thread
                    thread.start()
                    return

    def _serves(self, number: int, question: Question) -> bool:
        return question.asker.submits or number >= self._for_submissions

    def _loop(self, number: int) -> None:
        while (question := self._next(number)) is not None:
            try:
                if question.answer.set_running_or_notify_cancel():
                    question.answer.set_result(self._workers[number].answer(question))
            except Exception as error:  # noqa: BLE001 (the caller gets it)
                question.answer.set_exception(error)
            with self._changed:
                self._turns.ended(question)
                self._changed.notify_all()

    def _next(self, number: int) -> Question | None:
        """Wait for a worker's next question; None, with the worker at rest: a stop, or idle too long."""
        with self._changed:
            self._idle.add(number)
            # a question, True at a stop, or None when the time is over
            question = self._changed.wait_for(lambda: self._turn(number) or self._stopping, self._idle_s)
            self._idle.discard(number)
            if isinstance(question, Question):
                self._remember(question.subject, number)
                return question
            self._workers[number].rest()
            del self._threads[number]
            return None

    def _turn(self, number: int) -> Question | None:
        """Return the next question for a worker, none whose subject another idle worker has in memory."""

        def fits(question: Question) -> bool:
            home = self._worker_of.get(question.subject, number)
            return self._serves(number, question) and (home == number or home not in self._idle)

        return None if self._stopping else self._turns.next(fits)

    def _remember(self, subject: str, number: int) -> None:
        if subject:
            self._worker_of[subject] = number
            self._worker_of.move_to_end(subject)
            while len(self._worker_of) > _SUBJECTS:
                self._worker_of.popitem(last=False)
