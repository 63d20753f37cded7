"""How people and things look to a camera: clothing, paint, patterns; the laser sees nothing of it."""
