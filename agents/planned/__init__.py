"""Followers that plan: they compare many ways to drive on, each driven in thought among what moves and what stands."""
