"""A witness who fetches results all the time and notes whatever is not a whole and right one."""

from __future__ import annotations

import hashlib
import random
import threading
from collections import Counter
from collections.abc import Mapping
from contextlib import suppress

import httpx2
from running_service import PATIENCE_S, REFERENCES
from service_fake_work import is_slow_content

FILE = {"Accept": "application/x-netcdf"}
LOST = (httpx2.TransportError, ConnectionError)
_AT_ONCE = 10  # of those that were seen before


class Witness:
    """Looks at the results of jobs (the text of the wish by job; may grow meanwhile).

    `served` are digests by text, one each if all is well; `faults` is what should not have been.
    """

    def __init__(self, address: str, jobs: Mapping[str, str], headers: Mapping[str, str]) -> None:
        self._address, self._jobs, self._headers = address, jobs, headers
        self.served: dict[str, set[str]] = {}
        self.faults: list[str] = []
        self.answers: Counter[int] = Counter()
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._look)

    def start(self) -> None:
        self._thread.start()

    def stop(self) -> None:
        self._stop.set()
        self._thread.join()

    def _look(self) -> None:
        """Fetch what was not seen yet, and some of the rest."""
        chance = random.Random(1)
        with httpx2.Client(base_url=self._address, headers=self._headers, timeout=PATIENCE_S) as client:
            while not self._stop.wait(0.2):
                known = list(self._jobs.items())
                unseen = [one for one in known if one[1] not in self.served]
                for job, text in unseen + chance.sample(known, min(_AT_ONCE, len(known))):
                    with suppress(*LOST):
                        self._look_at(client, job, text)

    def _get(self, client: httpx2.Client, path: str, **more: Mapping[str, str]) -> httpx2.Response:
        answer = client.get(path, **more)  # type: ignore[arg-type]
        self.answers[answer.status_code] += 1
        return answer

    def _look_at(self, client: httpx2.Client, job: str, text: str) -> None:
        status = self._get(client, f"/v1/jobs/{job}/results", params=REFERENCES)
        if status.status_code != 200:
            if status.status_code not in (404, 503):
                self.faults.append(f"job {job}: {status.status_code} {status.text}")
            return
        answer = self._get(client, status.json()["database"]["href"], headers=FILE)
        if answer.status_code == 200:
            self.served.setdefault(text, set()).add(hashlib.sha256(answer.content).hexdigest())
            if not is_slow_content(answer.content, text):
                self.faults.append(f"{text}: {len(answer.content)} bytes, not its result")
        elif answer.status_code != 503:
            self.faults.append(f"{text}: {answer.status_code} {answer.text}")
