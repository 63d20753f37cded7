"""How well people are tracked: CLEAR MOT."""
