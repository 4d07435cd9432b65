"""Random pairs from the whole input space, feasible or not: each gives a sound table or one clear refusal."""
