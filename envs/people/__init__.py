"""Walking people: their gait, their routes and how they make room for each other."""
