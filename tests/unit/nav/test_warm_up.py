"""All kernels of navigation are compiled before a robot moves."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

import pioneer3.nav

WARM = """
import gc
from numba.core.dispatcher import Dispatcher
from pioneer3.nav.warm_up import warm_up
warm_up()
found = (each for each in gc.get_objects() if isinstance(each, Dispatcher) and each.signatures)
print(*(each.py_func.__name__ for each in found))
"""


def test_no_kernel_is_left_to_be_compiled_while_a_robot_drives() -> None:
    pytest.importorskip("numba")
    folder = Path(pioneer3.nav.__file__).parent
    sources = "".join(path.read_text() for path in folder.glob("*.py"))
    called = set(re.findall(r"fast\((\w+), CACHE\)", sources))
    run = subprocess.run([sys.executable, "-c", WARM], capture_output=True, text=True, check=True)
    assert len(called) > 15
    assert called - set(run.stdout.split()) == set()
