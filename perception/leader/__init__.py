"""Which of the tracked people leads the robot, and how it is recognised again."""
