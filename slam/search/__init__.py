"""Global search of a pose: scan points against a grid of scores, exact by branch and bound."""
