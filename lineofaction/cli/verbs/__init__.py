"""Arguments, help and examples of the verbs, a module for each family."""
