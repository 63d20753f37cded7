"""`tagalong data` says what a folder of recordings holds, by content and not by packing."""

import gzip
import hashlib
import json
import os
import re
from contextlib import nullcontext
from pathlib import Path

import numpy as np
import pytest
from full_disk import full_disk
from tagalong.scripts.cli import main
from tagalong.scripts.public_data import catalogue as catalogue_module
from tagalong.scripts.public_data.catalogue import catalogue
from tagalong.scripts.public_data.derive import derive
from tagalong.scripts.public_data.digest import content_digest


@pytest.fixture
def small_catalogue(tmp_path, monkeypatch):
    """A catalogue of two files, and a folder that holds both."""
    folder = tmp_path / "data"
    (folder / "logs").mkdir(parents=True)
    (folder / "logs" / "a.log.gz").write_bytes(gzip.compress(b"scan 1\n", mtime=1))
    np.savez(folder / "logs" / "b.npz", ranges=np.arange(3.0))
    names = ("a.log.gz", "b.npz")
    files = [{"name": name, "sha256": content_digest(folder / "logs" / name)} for name in names]
    told = {"collector": "C", "origin": "O", "licence": "L", "figures": "F"}
    content = {"collections": [{"name": "Two logs", "folder": "logs", **told, "files": files}]}
    (tmp_path / "catalogue.json").write_text(json.dumps(content))
    monkeypatch.setattr(catalogue_module, "_FILE", tmp_path / "catalogue.json")
    return folder


def test_a_folder_that_holds_everything_is_said_to_be_whole(small_catalogue, capsys):
    assert main(["data", "check", str(small_catalogue)]) == 0
    assert capsys.readouterr().out.splitlines()[-1].split() == ["Two", "logs", "2", "0", "0"]


def test_a_file_that_was_packed_anew_is_the_same_and_one_with_other_content_is_damaged(small_catalogue, capsys):
    packed = small_catalogue / "logs" / "a.log.gz"
    packed.write_bytes(gzip.compress(b"scan 1\n", compresslevel=1, mtime=2))
    np.savez_compressed(small_catalogue / "logs" / "b.npz", ranges=np.arange(3.0))
    assert main(["data", "check", str(small_catalogue)]) == 0
    packed.write_bytes(gzip.compress(b"scan 2\n"))
    (small_catalogue / "logs" / "b.npz").write_bytes(b"no zip")
    assert main(["data", "check", str(small_catalogue)]) == 1
    told = capsys.readouterr().out
    assert "damaged: logs/a.log.gz" in told
    assert "damaged: logs/b.npz" in told


def test_what_cannot_even_be_unpacked_is_damaged(small_catalogue, tmp_path):
    for name in ("a.gz", "a.xz", "a.zip", "a.npz", "a.bz2"):
        for content in (b"", b"nothing of the kind", b"PK\x05\x06" + bytes(18)):
            (tmp_path / name).write_bytes(content)
            assert content_digest(tmp_path / name) in (None, hashlib.sha256().hexdigest()), (name, content)
    (small_catalogue / "slam_logs").mkdir()
    (small_catalogue / "slam_logs" / "aces-corrected.log.gz").write_bytes(gzip.compress(b"ODOM 1 no number\n"))
    told = derive("slam_logs/aces_with_odometry.log.gz", small_catalogue, tmp_path)
    assert told.startswith("not made: slam_logs/aces-corrected.log.gz is damaged")
    assert list(tmp_path.rglob("aces_with*")) == []


def test_what_is_missing_is_named_by_file_or_all_together(small_catalogue, capsys):
    (small_catalogue / "logs" / "b.npz").unlink()
    assert main(["data", "check", str(small_catalogue)]) == 1
    assert "missing: logs/b.npz" in capsys.readouterr().out
    (small_catalogue / "logs" / "a.log.gz").unlink()
    assert main(["data", "check", str(small_catalogue)]) == 1
    assert "missing: all of Two logs, in logs" in capsys.readouterr().out


def test_a_folder_that_is_none_is_told_in_one_line(tmp_path, monkeypatch, capsys):
    monkeypatch.delenv("TAGALONG_DATA", raising=False)
    assert main(["data", "check"]) == 2
    assert "needs a folder: DIR, or the variable TAGALONG_DATA" in capsys.readouterr().err
    assert main(["data", "check", str(tmp_path / "nowhere")]) == 2
    assert main(["data", "check", str(tmp_path), "--only", "nowhere/"]) == 2


def test_odometry_is_integrated_over_the_readings_of_a_corrected_log(tmp_path, capsys):
    source = tmp_path / "slam_logs" / "aces-corrected.log.gz"
    source.parent.mkdir()
    lines = [
        "# a log",
        "ODOM 0 0 0 0 0 0 0.1 h 0.1",
        "ODOM 1 0 0 0 0 0 0.2 h 0.2",
        "FLASER 2 1.5 2 5 5 1.5708 5 5 1.5708 0.2 h 0.2",  # corrected: elsewhere
        "ODOM 5 5 1.570796326794 0 0 0 0.2 h 0.2",  # the reset after a scan, no reading
        "ODOM 5 6 1.570796326794 0 0 0 0.3 h 0.3",  # a metre ahead
        "FLASER 2 1.5 2 5 6 1.5708 5 6 1.5708 0.3 h 0.3",
    ]
    source.write_bytes(gzip.compress("\n".join(lines).encode()))
    assert main(["data", "derive", str(tmp_path)]) == 1  # the checksums are those of the true log
    told = capsys.readouterr().out
    assert "slam_logs/aces_with_odometry.log.gz: made, damaged" in told
    assert "legs/positive_1_scans.npz: not made: legs/positive_1.bag.xz is missing" in told
    made = gzip.decompress((tmp_path / "slam_logs" / "aces_with_odometry.log.gz").read_bytes()).decode().splitlines()
    assert made[2].split()[4:10] == ["5.000000", "5.000000", "1.570800", "1.000000", "0.000000", "0.000000"]
    assert made[3].split()[7:10] == ["2.000000", "0.000000", "0.000000"]


@pytest.mark.parametrize("full", [False, True], ids=["a file in the way", "a full disk"])
def test_where_nothing_can_be_written_one_line_says_so_and_no_other_file_is_tried(tmp_path, capsys, full):
    folder, into = tmp_path / "slam_logs", tmp_path / "new"
    folder.mkdir()
    ranges = " ".join(str(value) for value in np.random.default_rng(0).random(1000))
    for name in ("aces", "fhw"):
        log = f"FLASER 1000 {ranges} 0 0 0 0 0 0 0.1 h 0.1\n"
        (folder / f"{name}-corrected.log.gz").write_bytes(gzip.compress(log.encode()))
    if not full:
        into.write_text("in the way")
    with full_disk() if full else nullcontext():
        assert main(["data", "derive", str(tmp_path), "--into", str(into)]) == 2
    told = capsys.readouterr()
    assert re.fullmatch(r"tagalong: .*aces_with_odometry\.log\.gz: cannot be written \(.*\)\n", told.err)
    assert told.out == ""
    assert {path for path in tmp_path.rglob("*") if path.is_file() and path != into} == set(folder.iterdir())


@pytest.mark.skipif("TAGALONG_DATA" not in os.environ, reason="TAGALONG_DATA names no folder of recordings")
def test_what_is_derived_anew_of_the_recordings_at_hand_is_equal(tmp_path, capsys):
    folder = Path(os.environ["TAGALONG_DATA"])
    if not (folder / "slam_logs").is_dir():
        pytest.skip("no recordings in TAGALONG_DATA")
    pytest.importorskip("rosbags")
    assert main(["data", "derive", str(folder), "--into", str(tmp_path)]) == 0
    assert set(re.findall(r": (.*)", capsys.readouterr().out)) == {"made, ok"}


def test_every_collection_says_whose_it_is_and_what_rests_on_it():
    collections = list(catalogue())
    assert len(collections) > 10
    for each in collections:
        assert all((each.collector, each.origin, each.licence, each.figures, each.files)), each.name
        for file in each.files:
            assert len(file.sha256) == 64
            assert bool(file.made_from) == bool(file.how), file.path
    paths = [file.path for each in collections for file in each.files]
    assert len(paths) == len(set(paths))


@pytest.mark.skipif("TAGALONG_DATA" not in os.environ, reason="TAGALONG_DATA names no folder of recordings")
def test_the_recordings_at_hand_are_those_of_the_catalogue(capsys):
    folder = Path(os.environ["TAGALONG_DATA"])
    if not (folder / "slam_logs").is_dir():
        pytest.skip("no recordings in TAGALONG_DATA")
    assert main(["data", "check", str(folder), "--only", "slam_logs"]) == 0, capsys.readouterr().out
