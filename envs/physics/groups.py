"""MuJoCo's geom groups, by which rays and viewers choose what they see."""

GROUP_SEEN = 0
"""What the laser's plane can cut."""
GROUP_ABOVE = 1
"""What always stays above or below the laser's plane: table tops, heads, feet, the floor."""
GROUP_ROBOT = 2
"""The robot, which never sees itself."""
GROUP_HIDDEN = 3
"""Bodies of people for contacts only; viewers hide this group."""
GROUP_CEILING = 4
"""The ceiling: cameras below it see it, the view from above does not; viewers hide this group."""
