"""What handlers import when they are asked comes out whole, however many ask at once."""

from __future__ import annotations

import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from threading import Barrier

import pytest

from lineofaction.gearbox.loading import on_demand
from service.routes.warm_up import warm_up

MODULE = """
import sys, time
sys.being_loaded.append(__name__)
time.sleep(0.2)
sys.being_loaded.append(__name__)
def named(): return __name__
"""


def test_modules_are_loaded_one_after_the_other(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """By the thread that loads what requests will need, and by two that are asked meanwhile."""
    names = ["loaded_first", "loaded_on_demand", "loaded_beside_it"]
    for name in names:
        (tmp_path / f"{name}.py").write_text(MODULE, encoding="utf-8")
    monkeypatch.syspath_prepend(tmp_path)
    order: list[str] = []
    monkeypatch.setattr(sys, "being_loaded", order, raising=False)
    together = Barrier(2)

    def ask(name: str) -> str:
        together.wait()
        return str(on_demand(f"{name}:named")())

    thread = warm_up(names[:1])
    with ThreadPoolExecutor(2) as pool:
        assert list(pool.map(ask, names[1:])) == names[1:]
    thread.join()
    assert sorted(order) == sorted(names * 2)
    assert order[::2] == order[1::2], "another one was begun before this one had ended"
    for name in names:
        del sys.modules[name]
