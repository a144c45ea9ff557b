"""Maps from the logs of real robots, where they are."""

import gzip
from math import sqrt
from pathlib import Path

import numpy as np
import pytest

from benchmarks.nav_judge import trajectory_errors
from pioneer3.geometry import Pose2
from pioneer3.nav.beams import beams_of
from pioneer3.nav.carmen import read_carmen
from pioneer3.nav.logged import LoggedOdometry, LoggedScan
from pioneer3.nav.mapper import Mapper

DATASETS = Path(__file__).resolve().parents[4] / "shared" / "datasets"


@pytest.mark.parametrize(
    ("name", "rmse", "most"),
    [
        ("freiburg-101", 0.06, 0.20),
        pytest.param("intel-research-lab", 0.10, 0.30, marks=pytest.mark.thorough),
    ],
)
def test_a_log_of_a_real_robot_becomes_a_map(name: str, rmse: float, most: float) -> None:
    path = DATASETS / f"{name}.log.gz"
    if not path.exists():
        pytest.skip(f"{path} is missing")
    mapper, seen, truth = Mapper(), list[tuple[int, Pose2]](), list[Pose2]()
    with gzip.open(path, "rt") as lines:
        for entry in read_carmen(lines):
            if isinstance(entry, LoggedOdometry):
                mapper.move(entry.robot_in_odom)
                continue
            assert isinstance(entry, LoggedScan)
            assert entry.corrected is not None
            here = mapper.add(beams_of(entry.scan))
            last = len(mapper.survey.frames) - 1
            seen.append((last, mapper.survey.poses[last].inverse() @ here))
            truth.append(entry.corrected)
            mapper.improve()
    errors = trajectory_errors([mapper.survey.poses[k] @ off for k, off in seen], truth)
    assert sqrt(float(np.mean(errors**2))) < rmse
    assert errors.max() < most
