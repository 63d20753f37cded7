"""What graph SLAM does about a robot that was kidnapped or slipped far: notice it, relocalize, join the map again."""
