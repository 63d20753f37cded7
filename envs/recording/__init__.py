"""What happened in an episode, recorded: histories, rollouts and reference drives."""
