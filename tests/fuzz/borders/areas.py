"""All borders by area, in the order in which they are tried; what takes longest to make ready comes last."""

from borders import (
    archives,
    bags,
    checkpoints,
    engines,
    environment,
    filters,
    frames,
    logs,
    maps,
    models,
    options,
    perception,
    policies,
    public_data,
    recordings,
    scans,
    scores,
    tables,
    worlds,
)
from fuzzer.border import Area

AREAS: dict[str, Area] = {
    "logs": logs.AREA,
    "tables": Area((*tables.BORDERS, *scores.BORDERS)),
    "maps": maps.AREA,
    "bags": bags.AREA,
    "filter": filters.AREA,
    "scans": scans.AREA,
    "models": Area((*models.BORDERS, *policies.BORDERS), policies.warm),
    "engines": engines.AREA,
    "options": options.AREA,
    "perception": perception.AREA,
    "frames": frames.AREA,
    "record": recordings.AREA,
    "data": public_data.AREA,
    "environment": environment.AREA,
    "worlds": worlds.AREA,
    "checkpoints": Area((*checkpoints.BORDERS, *archives.BORDERS)),
}
