"""MuJoCo as type checkers can bear it, and the groups of geoms by which sensors and viewers choose what they see."""
