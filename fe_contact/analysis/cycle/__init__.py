"""Revolutions and hunting cycles of gears whose teeth differ."""
