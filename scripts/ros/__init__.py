"""Nodes of ROS 2: what each does with messages, without ROS (`..._logic`), and `node`, which hands them to it."""
