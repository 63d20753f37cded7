"""After how long a way a search is due again."""


class SearchInterval:
    """Counts the way since the last search.

    Args:
        way: Between two searches [m].
    """

    def __init__(self, way: float) -> None:
        self._way, self._travelled = way, 0.0

    def is_over(self, moved: float) -> bool:
        """Return whether a search is due, `moved` [m] after the last question; if so, the next way begins."""
        self._travelled += moved
        over = self._travelled >= self._way
        self._travelled = 0.0 if over else self._travelled
        return over
