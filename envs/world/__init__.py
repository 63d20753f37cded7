"""The simulated world: building, doors and people compiled into one MuJoCo model, and stepped."""
