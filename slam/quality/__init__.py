"""How good a map or a trajectory is: registration, ADNN, cell scores, trajectory errors, relations."""
