"""Studies of a case: accuracy, effects, sensitivity."""
