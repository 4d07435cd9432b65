"""Multibody dynamics of geared systems, excited by mesh-force tables."""
