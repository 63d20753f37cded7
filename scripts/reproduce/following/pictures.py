"""The figures of the published experiment."""

from pathlib import Path

import numpy as np

from ....agents.tour import SCENES
from ....slam.geometry import compose, inverse
from ...figures.canvas import save_png, side_by_side, stacked
from ...figures.maps import overlay_picture
from ...figures.plots import new_figure, save_figure
from ...figures.scans import scan_pair_picture
from ...figures.trajectory import trajectory_picture
from ...lab.cells import files_of
from ...lab.drive_files import load_input, load_truth
from ..report import Figure
from .map_files import load_map
from .maps import ENGINES, VARIANTS
from .plan import FULL_RANGE, SCANS, map_name, reference_name, tour_name
from .tables import PAPER_CM, TITLES, PaperResults

_COLOURS = {"raw": "#d62728", "filtered": "#1f57d6"}


def draw_scenes(cells: Path, folder: Path) -> Figure:
    """Draw both buildings as the laser's plane cuts them, with the tour through them (the paper's Fig. 3)."""
    pictures = []
    for scene in SCENES:
        files = files_of(f"slow/{scene}/s0", cells)
        truth, _ = load_map(files / "truth.npz")
        path = load_truth(files / "drive.npz")
        tour = compose(inverse(path[0]), path)
        pictures.append(trajectory_picture(truth, {"tour": tour}, TITLES[scene]))
    save_png(folder / "scenes.png", side_by_side(pictures))
    return Figure(file=folder / "scenes.png", caption="The buildings of seed 0 with the tour (Fig. 3).")


def draw_scan(cells: Path, folder: Path) -> Figure:
    """Draw the scan from which most was removed (the paper's Fig. 1 b, c)."""
    tour = load_input(files_of(tour_name("corridor", 2, "typical", 0), cells) / "drive.npz")
    raw = tour.drive.recording.scans
    removed = [int((a.is_return & ~b.is_return).sum()) for a, b in zip(raw, tour.filtered, strict=True)]
    at = int(np.argmax(removed))
    save_png(folder / "scan.png", scan_pair_picture(raw[at], tour.filtered[at]))
    return Figure(file=folder / "scan.png", caption="One scan, raw and with the people removed (Fig. 1).")


def draw_overlays(scene: str, cells: Path, folder: Path) -> Figure:
    """Draw the maps of seed 0 with 2 people on the reference (the paper's Figs 4 and 5)."""
    columns = []
    for engine in ENGINES:
        reference, _ = load_map(files_of(reference_name(scene, engine, 0), cells) / "map.npz")
        pictures = []
        for scans in SCANS:
            name = map_name(scene, 2, "typical", FULL_RANGE, engine, scans, 0)
            grid, _ = load_map(files_of(name, cells) / "map.npz")
            pictures.append(overlay_picture(grid, reference, f"{VARIANTS[engine]}, {scans} scans"))
        wide = pictures[0].width > 1.5 * pictures[0].height
        columns.append(stacked(pictures) if wide else side_by_side(pictures))
    save_png(folder / f"overlay_{scene}.png", stacked(columns))
    number = {"corridor": 4, "meeting_room": 5}[scene]
    caption = f"Maps of the {TITLES[scene]}, 2 people, seed 0, on the map of the slow drive (Fig. {number})."
    return Figure(file=folder / f"overlay_{scene}.png", caption=caption)


def draw_boxes(paper: PaperResults, folder: Path) -> Figure:
    """Draw mean, least and greatest ADNN of each cell (the paper's Fig. 6)."""
    figure = new_figure(11, 5)
    for column, scene in enumerate(SCENES):
        axes = figure.add_subplot(1, 2, column + 1)
        labels = []
        for place, (engine, people) in enumerate((e, p) for e in ENGINES for p in (1, 2)):
            found = paper.pair("adnn", scene, people, engine)
            for shift, (scans, values) in enumerate((("raw", found.raw), ("filtered", found.filtered))):
                x, cm = place + 0.36 * (shift - 0.5), 100.0 * values
                axes.bar(x, np.ptp(cm), 0.3, bottom=cm.min(), color=_COLOURS[scans], alpha=0.3)
                axes.plot(np.full(len(cm), x), cm, ".", color=_COLOURS[scans], ms=4)
                axes.plot([x - 0.15, x + 0.15], [cm.mean()] * 2, color=_COLOURS[scans], lw=2)
            printed = PAPER_CM.get((scene, people, engine), ("", ""))
            beside = f"\npaper:\n{printed[0]} -> {printed[1]}".replace("not printed", "?") if printed[1] else ""
            labels.append(f"{'GMapping' if engine == 'gmapping' else 'Cartographer'}, {people}p{beside}")
        axes.set_xticks(range(len(labels)), labels, fontsize=7)
        axes.set(title=TITLES[scene], ylabel="ADNN by equation 7 [cm]")
        axes.set_ylim(0.0, 1.15 * axes.get_ylim()[1])
        axes.grid(axis="y", alpha=0.3)
    handles = [figure.axes[0].bar(0, 0, color=colour, alpha=0.5) for colour in _COLOURS.values()]
    figure.axes[0].legend(handles, _COLOURS, loc="upper right", ncols=2)
    save_figure(folder / "boxes.png", figure)
    caption = "ADNN with and without filtering: mean (line), least to greatest (box), every drive (dots); Fig. 6."
    return Figure(file=folder / "boxes.png", caption=caption)
