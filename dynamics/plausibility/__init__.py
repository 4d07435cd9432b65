"""Plausibility of scenes: named checks with limits and sources. They warn and change no number."""

from __future__ import annotations

from dynamics.plausibility.scene_checks import CHECKS, scene_findings

__all__ = ["CHECKS", "scene_findings"]
