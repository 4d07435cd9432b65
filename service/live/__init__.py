"""Live answers: workers that keep condensed pairs, and their requests."""
