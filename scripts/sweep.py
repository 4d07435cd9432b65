"""Send random pairs through the library and keep a record of each.

Usage: sweep.py FOLDER plane|face COUNT [FIRST]; cases are the seeds from FIRST (0) on. Records of an earlier
call are kept, their cases not run again.
"""

from __future__ import annotations

import json
import sys
from collections import Counter
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "fakes"))

from random_cases import kind_of_end, sweep_case

from lineofaction.hardcases import run_scenes


def main(folder: Path, kind: str, count: int, first: int = 0) -> int:
    """Run cases that are not recorded; return how many ended in an unallowed way."""
    folder.mkdir(parents=True, exist_ok=True)
    file = folder / f"sweep-{kind}.jsonl"
    lines = file.read_text(encoding="utf-8").splitlines() if file.exists() else []
    done = {record["name"]: record for record in map(json.loads, lines)}
    scenes = [sweep_case(kind, seed) for seed in range(first, first + count)]  # type: ignore[arg-type]
    with file.open("a", encoding="utf-8") as records:
        for outcome in run_scenes([scene for scene in scenes if scene.name not in done]):
            record = outcome.to_json() | {"end": kind_of_end(outcome)}
            for words in ("family", "hard_because", "criterion", "bounds"):
                record.pop(words)
            done[record["name"]] = record
            records.write(json.dumps(record, allow_nan=False) + "\n")
            records.flush()
    ends = Counter(str(record["end"]) for record in done.values())
    sys.stdout.write(json.dumps({"cases": len(done), **ends}) + "\n")
    return sum(count for end, count in ends.items() if end not in ("table", "refusal"))


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]), sys.argv[2], int(sys.argv[3]), *map(int, sys.argv[4:])) > 0)
