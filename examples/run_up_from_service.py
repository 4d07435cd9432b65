"""The flow of Palermo et al. (ISMA 2010): STE tables from a service, the run-up here.

    loa serve                                  # in another terminal
    python examples/run_up_from_service.py     # has the table computed, fetches it, integrates 5 s
    python examples/run_up_from_service.py     # with the service stopped: the same run from the cache

The client computes nothing and keeps what it fetched; the dynamics knows neither the client nor the service.
"""

from __future__ import annotations

import argparse
from pathlib import Path

from main_job_summary import dynamic_lines, static_lines

from dynamics.simulation import simulate
from lineofaction.client import JobState, LineOfActionClient

EXAMPLES = Path(__file__).parent
CASE, SCENE = EXAMPLES / "palermo_spur_20_20.toml", EXAMPLES / "palermo_scene.toml"


def main() -> None:
    """Fetch, integrate, write, print."""
    parser = argparse.ArgumentParser(description="A run-up on a table of a service.")
    parser.add_argument("--service", help="its address; default: LOA_SERVICE, else this machine's")
    parser.add_argument("--cache", type=Path, help="folder of fetched tables; default: the user's cache")
    parser.add_argument("-o", "--output", type=Path, default=Path("run_up.nc"), help="file of the run")
    asked = parser.parse_args()

    def watch(state: JobState) -> None:
        print(f"{state.status} {state.stage}")

    with LineOfActionClient(asked.service, cache_dir=asked.cache, progress=watch) as client:
        table = client.analyze(CASE)
        scene = client.scene(SCENE)
    run = simulate(scene)
    run.to_netcdf(asked.output)
    print(*static_lines(table), *dynamic_lines(run), sep="\n")
    print(f"written to {asked.output}; a page with its plots: loa report {asked.output} -o report.html")


if __name__ == "__main__":
    main()
