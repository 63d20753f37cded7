"""All borders by area, in the order in which they are tried; what takes longest to make ready comes last."""

from borders import (
    archives,
    bags,
    checkpoints,
    engines,
    environment,
    logs,
    maps,
    models,
    options,
    perception,
    policies,
    scans,
    scores,
    tables,
)
from fuzzer.border import Area

AREAS: dict[str, Area] = {
    "logs": logs.AREA,
    "tables": Area((*tables.BORDERS, *scores.BORDERS)),
    "maps": maps.AREA,
    "bags": bags.AREA,
    "scans": scans.AREA,
    "models": Area((*models.BORDERS, *policies.BORDERS), policies.warm),
    "engines": engines.AREA,
    "options": options.AREA,
    "perception": perception.AREA,
    "environment": environment.AREA,
    "checkpoints": Area((*checkpoints.BORDERS, *archives.BORDERS)),
}
