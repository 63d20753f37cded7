"""All borders by area, in the order in which they are tried; what takes longest to make ready comes last."""

from borders import bags, checkpoints, engines, environment, logs, maps, models, options, perception, scans, tables
from fuzzer.border import Area

AREAS: dict[str, Area] = {
    "logs": logs.AREA,
    "tables": tables.AREA,
    "maps": maps.AREA,
    "bags": bags.AREA,
    "scans": scans.AREA,
    "models": models.AREA,
    "engines": engines.AREA,
    "options": options.AREA,
    "perception": perception.AREA,
    "environment": environment.AREA,
    "checkpoints": checkpoints.AREA,
}
