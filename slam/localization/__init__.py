"""Where on a finished map the robot is: from nothing, and from scan to scan."""
