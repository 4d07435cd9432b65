"""Times and errors of the main job; `scripts/bench` runs them all."""
