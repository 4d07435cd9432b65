"""HTTP: handlers validate and enqueue; they solve nothing."""
