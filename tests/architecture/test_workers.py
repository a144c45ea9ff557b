"""The processes in which tests run: no test is lost, whatever its process does."""

import re
import subprocess
import sys
from pathlib import Path

RUN = """
import sys, pytest
from tests.workers import Workers
sys.exit(pytest.main(sys.argv[1:], [Workers(2, lambda: None)]))
"""
DIES = """
import os
def test_first(): pass
def test_dies(): os._exit(0)
def test_after(): pass
"""
FAILS = """
def test_prints(capfd): print("a"); assert capfd.readouterr().out
def test_fails(tmp_path): assert not tmp_path
"""


def test_each_test_has_a_result_also_when_its_process_dies(tmp_path: Path) -> None:
    (tmp_path / "pytest.ini").write_text("[pytest]\naddopts = -v -p no:cacheprovider -p no:asyncio")
    (tmp_path / "test_dies.py").write_text(DIES)
    (tmp_path / "test_fails.py").write_text(FAILS)
    done = subprocess.run(
        [sys.executable, "-c", RUN, str(tmp_path)], capture_output=True, text=True, check=False
    )
    assert done.returncode == 1, done.stderr
    assert dict(re.findall(r"::(\w+) (PASSED|FAILED)", done.stdout)) == {
        "test_first": "PASSED",
        "test_dies": "FAILED",
        "test_after": "FAILED",
        "test_prints": "PASSED",
        "test_fails": "FAILED",
    }
    assert "died" in done.stdout
