"""Two results against each other, and against what was measured: differences with their errors."""
