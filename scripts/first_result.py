"""Write the first result of the page: the answer of a running service to the first example."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

import httpx2

FILE = Path(__file__).parents[1] / "service" / "page" / "static" / "first.json"
DIGITS = 5


def rounded(value: Any) -> Any:
    """Return an answer with the digits that a picture needs."""
    if isinstance(value, float):
        return float(f"{value:.{DIGITS}g}")
    if isinstance(value, list):
        return [rounded(item) for item in value]
    return {key: rounded(item) for key, item in value.items()} if isinstance(value, dict) else value


def first_result(service: str) -> dict[str, Any]:
    """Return the case of the first example, its title and its live answer at the middle torque."""
    with httpx2.Client(base_url=service, timeout=300.0) as http:
        example = http.get("/v1/examples").json()[0]
        report = http.get(f"/v1/results/{example['hash']}/figures").json()
        torques = example["case"]["load"]["torque_n_m"]
        question = {"torque_n_m": [torques[len(torques) // 2]], "flanks": True, "passage": True}
        (curve,) = http.post(f"/v1/databases/{example['hash']}/ste", json=question).json()["curves"]
    return {
        "case": example["case"],
        "title": f"{report['title']}, {report['lead']}",
        "curve": rounded(curve),
    }


if __name__ == "__main__":
    FILE.write_text(json.dumps(first_result(sys.argv[1]), separators=(",", ":")) + "\n", encoding="utf-8")
