"""Studies of micro-geometry: many designs of one pair on one compliance."""
