"""Influence of effects, estimated without finite elements: teeth as Weber and Banaschek's springs."""
