"""Tables of the report."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from ...lab.statistics import t_mean
from ..report import Table
from .cells import DISTANCES, NEIGHBOURS, REACHES
from .drives import ROBOTS
from .judgement import Compared, Consistency, Worlds, compare_all, recovery
from .methods import METHODS, PAPER
from .speed import SIZES


def methods_table(worlds: Worlds) -> Table:
    """Return time and error of every method."""
    rows = []
    for key, name in METHODS.items():
        ms, rms = worlds.cluster_ms(key), worlds.error(key, "typical", "slam")
        sightings = np.mean([row["sightings"][key] for row in worlds.rows])
        rows.append(
            [
                name,
                f"{t_mean(ms, least=0.0).text(digits=3)}; {np.median(ms):.3f}",
                f"{t_mean(worlds.total_s(key), least=0.0).text(digits=2)}",
                f"{t_mean(rms, least=0.0).text(100.0, 1)}; {100.0 * np.median(rms):.1f}",
                t_mean(worlds.error(key, "typical", "localization"), least=0.0).text(100.0, 1),
                t_mean(worlds.error(key, "perfect", "slam"), least=0.0).text(100.0, 2),
                t_mean(worlds.error(key, "typical", "lost"), least=0.0).text(100.0, 1),
                f"{sightings:.2f}",
            ]
        )
    blind = [t_mean(worlds.error("dbscan", robot, "odometry"), least=0.0).text(100.0, 1) for robot in ROBOTS]
    rows.append(["no filter: odometry alone", "", "", blind[1], blind[1], blind[0], "", ""])
    return Table(
        title="Four methods: time and error",
        columns=(
            "method",
            "clustering a scan [ms]: mean; median",
            "whole drive [s]",
            "EKF-SLAM, robot 2 [cm]: mean; median",
            "localization on the known map, robot 2 [cm]",
            "EKF-SLAM, robot 1 [cm]",
            "EKF-SLAM, 6 m without landmarks [cm]",
            "landmarks a scan",
        ),
        rows=rows,
        note=f"RMS position error in the frame of the first pose, nothing aligned; {len(worlds.rows)} worlds, mean "
        "with 95 % interval. CPU time of one thread; of K-Means and GMM with fitting 1 to 12 objects and choosing.",
    )


def y_table(worlds: Worlds) -> Table:
    """Return the paper's own error, and ATE beside it."""
    rows = []
    for key in PAPER:
        row = [METHODS[key]]
        for robot in ROBOTS:
            row += [
                t_mean(worlds.error(key, robot, "slam", "y_sum_m"), least=0.0).text(1.0, 2),
                t_mean(worlds.error(key, robot, "slam", "ate_m"), least=0.0).text(100.0, 2),
            ]
        rows.append(row)
    return Table(
        title="Figure 4 in numbers: accumulated error of y where x coincides, ATE beside it",
        columns=("method", "robot 1: y [m]", "robot 1: ATE [cm]", "robot 2: y [m]", "robot 2: ATE [cm]"),
        rows=rows,
        note="EKF-SLAM. y is summed over the scans used, looked for within 2 m of way; where the path runs along y it "
        "says little. ATE after the best rigid motion.",
    )


def claim_table(worlds: Worlds) -> Table:
    """Return the paired test of the paper's claim."""
    rows = []
    measures = {
        "error, robot 2": {name: worlds.error(name, "typical", "slam") for name in PAPER},
        "accumulated y, robot 2": {name: worlds.error(name, "typical", "slam", "y_sum_m") for name in PAPER},
        "localization error, robot 2": {name: worlds.error(name, "typical", "localization") for name in PAPER},
        "time of the drive": {name: worlds.total_s(name) for name in PAPER},
        "time of clustering": {name: worlds.cluster_ms(name) for name in PAPER},
    }
    for measure, values in measures.items():
        rows += [_test_row(measure, found, len(worlds.rows)) for found in compare_all(values)]
    return Table(
        title="Is DBSCAN fastest, and 5 % better?",
        columns=("measure", "DBSCAN against", "ratio of means", "equal in", "p (Holm)", "verdict"),
        rows=rows,
        note="Wilcoxon's signed ranks over the same worlds. The paper's claim asks for a ratio of 0.95 or less.",
    )


def _test_row(measure: str, found: Compared, count: int) -> list[str]:
    return [
        measure,
        METHODS[found.other],
        found.ratio.text(digits=3),
        f"{found.equal} of {count}",
        f"{found.p:.2g}",
        found.verdict,
    ]


def consistency_table(rows: Sequence[Mapping[str, Any]], found: Consistency) -> Table:
    """Return what the engine as it ships reaches, with the odometry error that is usual."""
    path = [row["path_m"] for row in rows]
    words = [
        ["worlds, path [m], posts (fewest)", f"{len(rows)}, {np.mean(path):.0f}, {min(row['posts'] for row in rows)}"],
        ["RMS position error [cm]", t_mean([row["rms_m"] for row in rows], least=0.0).text(100.0, 1)],
        ["ATE [cm]", t_mean([row["ate_m"] for row in rows], least=0.0).text(100.0, 1)],
        ["largest RMS error [cm]", f"{100.0 * max(row['rms_m'] for row in rows):.1f}"],
        ["odometry alone, RMS [cm]", t_mean([row["odometry_rms_m"] for row in rows], least=0.0).text(100.0, 1)],
        ["average NEES, mean over steps (3 is right)", f"{found.average.mean():.2f}"],
        ["95 % bounds", f"{found.low:.2f} to {found.high:.2f}"],
        ["steps within the bounds [%]", f"{100.0 * found.inside:.1f}"],
    ]
    return Table(title="EKF-SLAM with DBSCAN as it ships", columns=("quantity", "value"), rows=words)


def recovery_table(rows: Sequence[Mapping[str, Any]]) -> Table:
    """Return how many worlds came back after all landmarks were lost."""
    words = []
    for name, found in recovery(rows).items():
        words.append(
            [
                name,
                str(found["worlds"]),
                _or_dash(found["peak_m"], lambda metres: f"{100.0 * metres:.0f}"),
                found["back"].text(100.0, 1),
                found["of_those_beyond"].text(100.0, 1) + f" of {found['of_those_beyond'].n}",
                found["stayed"].text(100.0, 1),
                _or_dash(found["p_more_than_95"], lambda p: f"{p:.2g}"),
                _or_dash(found["after_m"], lambda metres: f"{100.0 * metres:.1f}"),
                str(found["lost_before"]),
            ]
        )
    return Table(
        title="After all landmarks were lost",
        columns=(
            "without landmarks",
            "worlds",
            "peak error [cm]",
            "below 10 cm 3 m on [%]",
            "of those that were beyond 10 cm [%]",
            "and for the rest [%]",
            "p, against 95 %",
            "median error then [cm]",
            "beyond 10 cm before the loss",
        ),
        rows=words,
        note="Position error in the frame of the first pose, nothing aligned. On the second lap the laser is covered; "
        "3 m are counted from the first landmark seen again. A slip is a jump of the odometry by 0.1 to 0.5 m and up "
        "to 10 degrees that no covariance knows of. p: exact binomial test that the share is more than 95 %.",
    )


def _or_dash(value: float | None, text: Callable[[float], str]) -> str:
    return "-" if value is None else text(value)


def sweep_tables(rows: Sequence[Mapping[str, Any]]) -> list[Table]:
    """Return error and time over the three parameters."""
    parameters = (
        ("distance", "Minimum cluster distance [m]", DISTANCES, ("heuristic", "dbscan")),
        ("neighbours", "Minimum neighbours", NEIGHBOURS, ("heuristic", "dbscan")),
        ("range", "Laser range [m]", REACHES, PAPER),
    )
    return [_sweep_table(rows, *parameter) for parameter in parameters]


def _sweep_table(
    rows: Sequence[Mapping[str, Any]], key: str, title: str, values: Sequence[float], names: Sequence[str]
) -> Table:
    words = []
    for value in values:
        row = [f"{value:g}"]
        for name in names:
            points = [world[f"{name}/{key}/{value}"] for world in rows if f"{name}/{key}/{value}" in world]
            row += [
                t_mean([point["rms_m"] for point in points], least=0.0).text(100.0, 1),
                f"{np.mean([point['timing']['cluster_ms'] for point in points]):.3f}",
            ]
        words.append(row)
    columns = [word for name in names for word in (f"{METHODS[name]}: RMS error [cm]", "clustering [ms]")]
    note = "EKF-SLAM, robot 2. K-Means and GMM on fewer worlds than the others."
    return Table(title=title, columns=("value", *columns), rows=words, note=note if key == "range" else "")


def speed_table(timing: Mapping[str, Mapping[str, float]]) -> Table:
    """Return the milliseconds of a full step."""
    rows = [[METHODS[name], *(f"{sizes[str(size)]:.2f}" for size in SIZES)] for name, sizes in timing.items()]
    return Table(
        title="One full step [ms] by landmarks in the map",
        columns=("method", *(str(size) for size in SIZES)),
        rows=rows,
        note="181 beams, one thread: cluster, associate, update. The update writes the whole covariance, so it "
        "grows with the square of the landmarks once that outgrows the cache; association looks at near ones only.",
    )


def legs_table(found: Mapping[str, Mapping[str, float]]) -> Table:
    """Return what DBSCAN makes of labelled legs."""
    rows = []
    for epsilon, counts in found.items():
        legs = counts["legs"]
        kinds = ("alone", "shared", "in_larger", "missed", "landmarks")
        rows.append([epsilon, *(f"{counts[kind]} ({100.0 * counts[kind] / legs:.0f} %)" for kind in kinds)])
    return Table(
        title="DBSCAN on labelled legs (Leigh et al. 2015), 3 points and more",
        columns=(
            "epsilon [m]",
            "a cluster of its own",
            "shared with another leg",
            "in something larger",
            "noise",
            "whole: fit for a landmark",
        ),
        rows=rows,
        note="749 legs in 455 scans. The labels are themselves means of clusters, so the distance between both says "
        "nothing. Few are whole: this laser measures nothing beside an edge, and what is hidden there is not known.",
    )


def logs_table(results: Mapping[str, Mapping[str, Any]]) -> Table:
    """Return the landmark engine beside the grid engines on recorded drives."""
    rows = []
    for name, found in results.items():
        _, log, engine = name.split("/")
        seen = f"{found['sightings']:.1f} / {found['matched']:.1f}" if "sightings" in found else ""
        rows.append(
            [log, engine, f"{found['ate_m']:.2f}", f"{found['odometry_ate_m']:.2f}", seen, _seconds(found["timing"])]
        )
    return Table(
        title="Recorded drives",
        columns=("log", "engine", "ATE [m]", "odometry alone [m]", "landmarks a scan: seen / matched", "time [s]"),
        rows=rows,
        note="Against the log's own corrected poses. Halls of walls hold few round things: about one a scan, less than "
        "half of it seen before. Two are needed for a pose, so the landmark engine drifts there.",
    )


def _seconds(timing: Mapping[str, float]) -> str:
    return f"{timing['seconds']:.1f}"
