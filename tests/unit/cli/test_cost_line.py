"""The summary of `loa analyze` says what it cost."""

from lineofaction.cli.analyze import _cost


def cost(receipt: dict[str, object]) -> str:
    return "\n".join(_cost(receipt, newton_metre=1.0))


def receipt() -> dict[str, object]:
    stages = {"compliance": {"cpu_seconds": 0.25}, "contact": {"cpu_seconds": 1.5}}
    return {
        "stages": stages,
        "cpu_seconds": 1.75,
        "peak_memory_bytes": 300 * 2**20,
    }


def test_time_by_stage_and_memory():
    assert cost(receipt()) == "cost 1.75 CPU s (compliance 0.25, contact 1.5), 300 MiB"


def test_held_out_errors_are_named_by_axis():
    measured = {
        "force": {"at": [1.0], "error_m": [[2e-8]]},
        "center_distance_change": {"at": [1e-4, 3e-4], "error_m": [[1e-7, 3.4e-7], [None, 1e-9]]},
    }
    text = cost(receipt() | {"held_out": measured})
    assert "between the nodes: force 0.02 µm, center distance change unknown" in text


def test_contacts_that_outgrew_their_patch_are_counted():
    assert "outgrew its load patch at 185 points" in cost(receipt() | {"patch_outgrown_points": 185})
    assert "outgrew" not in cost(receipt() | {"patch_outgrown_points": 0})
