"""Bodies that the service answers with, as they are shown in the description."""

from __future__ import annotations

from typing import Any

from lineofaction.gearbox.registry import RESULTS
from service.schemas.examples import BODIES, CASE, DRAFTS
from service.version import solver_version

Json = dict[str, Any]
HASH = "5f1d8a3c0e7b4692d85c13f7a9e06b24c7d3185ae94f620bb1873ce5f90d24a6"
JOB = "3f1c0e5a-6c3d-4c1e-9b1e-2f6f0a1b2c3d"
_INSTANT = "2026-01-31T12:00:00.000000Z"
_LINK = {"href": "/v1/jobs", "rel": "self", "type": "application/json", "title": "This page"}
STATUS: Json = {
    "processID": "analyze",
    "type": "process",
    "jobID": JOB,
    "status": "running",
    "title": "Tip relief 20 µm",
    "tags": ["ev-3", "draft"],
    "priority": 0,
    "max_cost_s": 600.0,
    "subject": "20/20, module 4 mm, up to 400 N m",
    "differences": {
        "since": "8a1d2c3b-2f6f-4d1c-8b1e-6c3d0a1b2c3e",
        "first": [{"field": "case.pair.pinion.tip_relief_um", "before": 0.0, "value": 20.0}],
        "number": 1,
    },
    "message": "Runs: compliance.",
    "created": _INSTANT,
    "started": _INSTANT,
    "finished": None,
    "updated": _INSTANT,
    "progress": 24,
    "remaining_s": 19.0,
    "ahead": None,
    "stage": "compliance",
    "stage_progress": 40,
    "attempts": 1,
    "headline": None,
    "links": [_LINK | {"href": f"/v1/jobs/{JOB}", "title": "Status"}],
}
_SUMMARY: Json = {
    "id": "analyze",
    "title": "STE database of a gear pair",
    "description": "Contact analysis of a gear pair over positions and loads; makes an STE database.",
    "version": "1",
    "jobControlOptions": ["async-execute", "dismiss"],
    "outputTransmission": ["value", "reference"],
    "links": [_LINK | {"href": "/v1/processes/analyze", "title": "Description"}],
    "additionalParameters": {"title": "Card", "parameters": []},
}
_OUTPUT = {"type": "string", "contentEncoding": "binary", "contentMediaType": "application/x-netcdf"}
_RESULT: Json = {"hash": HASH, "sha256": HASH[::-1], "size": 153_344}
_CURVE: Json = {
    "torque_n_m": 100.0,
    "normal_force_n": 2660.4,
    "misalignment_um": 0.0,
    "center_distance_change_mm": 0.0,
    "period": 1,
    "position": [0.0, 0.5],
    "ste_um": [9.7, 12.1],
    "pair": [-1, 0],
    "load_share": [[0.5, 0.5], [0.0, 1.0]],
    "mean_um": 10.9,
    "peak_to_peak_um": 2.8,
    "harmonics_um": [1.1, 0.4],
}
_SOURCE = {"mean": 0.01, "peak_to_peak": 0.02, "first_harmonic": 0.01}
_ASSUMED = {
    "effect": "coast_flank",
    "assumption": "coast flanks stay apart",
    "holds": True,
    "reason": "the least clearance is 12 µm",
}
_LIVE: Json = {
    "curves": [
        _CURVE
        | {
            "mean_error_um": 0.02,
            "peak_to_peak_error_um": 0.03,
            "harmonics_error_um": [0.02, 0.01],
            "error_by_source_um": {"discretisation": _SOURCE},
        }
    ],
    "effects": {"corner_contact": True},
    "beyond_load_patches": 0,
    "discretisation_error": "measured",
    "not_estimated": [],
    "residuals_max": 1e-12,
    "assumptions": [_ASSUMED],
    "not_checked": [],
    "cost": {
        "compliance_cpu_seconds": 0.001,
        "contact_cpu_seconds": 0.02,
        "error_estimate_cpu_seconds": 0.02,
    },
    "cpu_seconds": 0.04,
}
_REPORT: Json = {
    "title": "STE database",
    "lead": "20/20 teeth, module 4 mm",
    "alarms": [],
    "headlines": [{"name": "peak to peak at 100 N m", "value": "2.80 µm"}],
    "sections": [
        {
            "title": "Transmission error",
            "part": "results",
            "text": "",
            "figures": [],
            "tables": [],
            "folded": [],
        }
    ],
}
_COST = {
    "stages": {"compliance": 2.1, "contact": 0.4},
    "cpu_seconds": 2.5,
    "correction": {"compliance": 1.0, "contact": 1.0},
    "memory_bytes": 310_000_000,
    "positions": 64,
}
_ERROR = {
    "mesh": 0.004,
    "slices": 0.0,
    "positions": 0.002,
    "numerical": 0.0045,
    "plane": 0.001,
    "method": 0.003,
    "total": 0.0055,
    "bias": None,
    "mean_um": 0.06,
    "peak_to_peak_um": 0.02,
}
_EFFECT: Json = {
    "name": "tooth_coupling",
    "on": True,
    "choice": "auto",
    "cost": "none: the blocks come with the condensed compliance",
    "called_for": True,
    "reason": "contact ratio 1.560: neighboring pairs share the load",
    "decision": "the scene calls for it",
    "influence": None,
    "cost_cpu_seconds": 0.0,
    "price": "",
    "checked": "no; toggling it measures it (ablation)",
    "holds": None,
}
_MESH: Json = {"model": "plane strain", "level": "standard", "slices": 1}
_LEVEL = _MESH | {"cost": _COST, "error": _ERROR}
_PLAN: Json = {
    "choice": _MESH | {"met": True, "reason": "the cheapest that meets the tolerance"},
    "prediction": _COST,
    "error": _ERROR,
    "levels": [_LEVEL],
    "passes": [_LEVEL],
    "conflict": "",
    "plan": {
        "model": "plane_strain",
        "mesh": [{"flank_size": 0.0004, "layers": 12}] * 2,
        "patch": {"half_width": 0.001, "edge_length": 0.0001, "edge_load": 1e-6},
        "positions": "adaptive",
        "load": [2660.0],
        "support_load": [26.6, 5320.0],
    },
    "warnings": [],
    "effect_ledger": [_EFFECT],
}
_DETAILS: dict[str, Json] = {
    "urn:lineofaction:problem:not-found": {
        "detail": f"There is no database {HASH!r}. Submit its case again to compute it.",
    },
    "urn:lineofaction:problem:bad-input": {
        "detail": "pair.pinion.bore_diameter_mm = 95.0: must be below the root diameter 70 mm (bore). "
        "Lower the bore or add teeth.",
        "errors": [
            {
                "field": "pair.pinion.bore_diameter_mm",
                "value": 95.0,
                "bound": "below the root diameter 70 mm (bore)",
                "suggestion": "Lower the bore or add teeth.",
            }
        ],
    },
    "urn:lineofaction:problem:queue-full": {
        "detail": "100 computations wait already. Try again later.",
    },
}
"""Further members of some problems, by type."""


def _outline(height_mm: float, turn: float) -> Json:
    return {
        "teeth": 20,
        "tooth_mm": [[-6.2, 34.5], [-2.0, 44.0], [2.0, 44.0], [6.2, 34.5]],
        "radius_mm": {
            "tip": 44.0,
            "root": 35.0,
            "base": 37.588,
            "reference": 40.0,
            "held": 20.0,
            "form": 37.64,
        },
        "angle_deg": 0.0,
        "centre_mm": [0.0, height_mm],
        "turn": turn,
        "face_mm": [-12.5, 12.5],
        "twist_deg_per_mm": 0.0,
    }


ANSWERS: dict[str, Any] = {
    "/v1": {
        "title": "lineofaction",
        "description": "STE databases of gear pairs.",
        "version": solver_version(),
        "links": [_LINK],
    },
    "/v1/conformance": {"conformsTo": ["http://www.opengis.net/spec/ogcapi-processes-1/1.0/conf/core"]},
    "/v1/processes": {"processes": [_SUMMARY], "links": [_LINK]},
    "/v1/processes/{process_id}": _SUMMARY
    | {
        "inputs": {"case": {"title": "case", "description": "The case", "schema": {"type": "object"}}},
        "outputs": {"database": {"title": "database", "description": "The table", "schema": _OUTPUT}},
    },
    "/v1/batches": STATUS
    | {"message": "1 of 2 jobs have ended.", "stage": "jobs", "stage_progress": 50, "children": 2},
    "/v1/jobs": {"jobs": [STATUS], "links": [_LINK]},
    "/v1/jobs/{job_id}": STATUS,
    "/v1/jobs/{job_id}/inputs": {"processID": "analyze", "inputs": {"case": CASE}},
    "/v1/jobs/{job_id}/results": {
        "database": {"href": f"{RESULTS}/{HASH}", "type": "application/x-netcdf", "hash": HASH}
    },
    "/v1/jobs/{job_id}/events": f'event: status\ndata: {{"jobID": "{JOB}", "status": "running"}}\n\n',
    "/v1/databases": {
        "databases": [
            {
                "hash": HASH,
                "href": f"{RESULTS}/{HASH}",
                "created": _INSTANT,
                "size": 153_344,
                "case": CASE,
            }
        ],
        "links": [_LINK | {"href": "/v1/databases"}],
    },
    "/v1/databases/{key}/query": {
        "force_n": [1834.2, 2651.8],
        "stiffness_n_per_um": [371.5, 402.3],
        "validity": ["inside", "inside"],
        "force_error_n": [4.1, 5.0],
    },
    "/v1/databases/{key}/ste": _LIVE,
    "/v1/plans": _PLAN,
    "/v1/examples": [
        {
            "name": "spur",
            "title": "Spur 20/20",
            "note": "Seconds.",
            "case": CASE,
            "hash": HASH,
            "stored": True,
        }
    ],
    "/v1/cases/outline": {
        "pinion": _outline(0.0, -1.0),
        "wheel": _outline(80.0, 1.0),
        "internal": False,
        "path_of_contact": {"points_mm": {"A": [-9.4, -3.4], "E": [9.4, 3.4]}, "base_pitch_mm": 11.8},
        "figures": {"transverse_contact_ratio": 1.56, "working_pressure_angle_deg": 20.0},
    },
    "/v1/cases/from-toml": {"case": CASE},
    "/v1/cases/to-toml": BODIES["/v1/cases/from-toml"],
    "/v1/cases/as-made": {"case": CASE, "left_out": []},
    "/v1/scenes/from-toml": BODIES["/v1/scenes/to-toml"]["inputs"],
    "/v1/scenes/to-toml": BODIES["/v1/scenes/from-toml"],
    "/v1/scenes/to-files": BODIES["/v1/scenes/from-toml"],
    "/v1/scenes/housing-surface": {"surface": None},
    "/v1/units/open": {
        "left_out": ["gear_unit 1, scene: no load case fits the train"],
        "cases": [],
        "scene": None,
        "load_cases": [],
        "lines": [
            {
                "place": "component 1",
                "component": 1,
                "kind": "gear_unit",
                "name": "",
                "item": "scene",
                "fate": "refused",
                "words": "no load case fits the train",
                "line": None,
            }
        ],
        "summary": ["refused   gear_unit 1, scene: no load case fits the train"],
    },
    "/v1/effects": [
        {
            "name": "corner_contact",
            "needs": ["gap"],
            "adds": ["pairs outside the path of contact"],
            "cost": "two more tooth pairs",
            "sources": ["exact rigid gap on the line of action"],
            "valid_for": "external and internal pairs",
        }
    ],
    "/health": {"status": "ok"},
    "/ready": {"status": "ready", "computations": {"successful": 3}},
    f"{RESULTS}/{{key}}": _RESULT,
    f"{RESULTS}/{{key}}/figures": _REPORT,
    f"{RESULTS}/{{key}}/motion": {
        "groups": [{"name": "at rest", "motions": ["412 Hz, torsion, damping 2 %"]}],
        "motion": None,
    },
}
"""Answers that succeeded, by path."""


ANSWERS |= {draft: ANSWERS[path] for draft, path in DRAFTS.items()}


def answer_example(path: str) -> Any:
    """Return the answer of a path, None if there is none."""
    return STATUS if path.endswith("/execution") else ANSWERS.get(path)


def problem_example(status: int, kind: str, title: str) -> Json:
    """Return a problem of a type."""
    plain = {"type": kind, "title": title, "status": status, "detail": f"{title}.", "errors": []}
    return plain | _DETAILS.get(kind, {})
