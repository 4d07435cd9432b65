"""A housing of a scene from the STEP file of its solid: where it stands, its bearing seats and its foot."""
