"""The task of an episode: observations, rewards, endings and coverage."""
