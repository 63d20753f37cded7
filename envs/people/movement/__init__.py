"""How bodies move along their ways and round each other; compiled where it is called for everybody in every tick."""
