"""A key that floods the live workers, beside one that asks a few."""

import threading
from collections import Counter
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack, contextmanager
from dataclasses import replace

import httpx2
import pytest
from running_service import PATIENCE_S
from served_app import served
from whole_service import CASE

import service.routes.queries
from service.access.key_file import KeyFile
from service.app import create_app
from service.live.question_pool import QuestionPool
from service.settings import Settings
from service.worker.process import Registry, default_registry

PLAN = "live_fake_work:plan"
FLOOD, EACH = 40, 20
BODY = {"inputs": {"case": CASE}}
SUBMISSION = "/v1/processes/analyze/execution"


@contextmanager
def flooded(address: str, key: dict[str, str], pool: QuestionPool) -> Iterator[Counter[int]]:
    """Ask on many connections what is never answered; give the statuses of what is."""
    statuses, ended = Counter[int](), threading.Event()

    def ask(number):
        body = {"inputs": {"case": CASE, "time_budget_s": 1.0}, "caller": f"slider-{number}"}
        with httpx2.Client(base_url=address, timeout=PATIENCE_S, headers=key) as http:
            while not ended.is_set():
                statuses[http.post("/v1/plans", json=body).status_code] += 1
                ended.wait(0.2)

    with ThreadPoolExecutor(FLOOD) as threads:
        for number in range(FLOOD):
            threads.submit(ask, number)
        try:
            yield statuses
        finally:
            ended.set()
            pool.stop()


@pytest.mark.law
def test_a_flood_of_one_key_takes_nothing_from_another(tmp_path, monkeypatch):
    monkeypatch.setattr(service.routes.queries, "PLAN", PLAN)
    registry = default_registry()
    registry = Registry(replace(registry["analyze"], plan=PLAN))
    settings = Settings(data_directory=tmp_path / "data")
    file = KeyFile(settings.key_file)
    flood, victim = ({"Authorization": f"Bearer {file.add(name)}"} for name in ("flood", "victim"))
    app = create_app(settings, registry, works=False)
    with ExitStack() as stack:
        address = f"http://127.0.0.1:{stack.enter_context(served(app))}"
        statuses = stack.enter_context(flooded(address, flood, app.state.context.live))
        with httpx2.Client(base_url=address, timeout=PATIENCE_S, headers=victim) as http:
            plans = Counter(http.post("/v1/plans", json=BODY).status_code for _ in range(EACH))
            checked = BODY | {"max_cost_s": 5}
            jobs = Counter(http.post(SUBMISSION, json=checked).status_code for _ in range(EACH))
            assert http.post(SUBMISSION, json=checked | {"max_cost_s": 0.1}).status_code == 422
        assert (plans, jobs) == (Counter({200: EACH}), Counter({201: EACH}))
        assert not statuses, "the flood waits for its first answers"
