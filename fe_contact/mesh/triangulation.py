"""Straight triangles inside outlines, by gmsh in a child process."""

from __future__ import annotations
