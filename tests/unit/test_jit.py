"""Compiled kernels and where they are kept."""

import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import pytest

from pioneer3 import jit

numba = pytest.importorskip("numba")


def test_threads_that_load_kernels_keep_each_in_its_own_folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    seen: dict[str, str] = {}

    def njit(**_: Any) -> Any:
        def wrap(function: Any) -> Any:
            time.sleep(0.02)  # another thread begins
            seen[function.__name__] = numba.config.CACHE_DIR
            return function

        return wrap

    def some(name: str) -> Any:
        function = eval("lambda: 1")
        function.__name__ = name
        return jit.kernel(function)

    monkeypatch.setattr(numba, "njit", njit)
    before = numba.config.CACHE_DIR
    names = [f"kernel{n}" for n in range(8)]
    with ThreadPoolExecutor(8) as pool:
        list(pool.map(lambda name: jit._compiled(some(name), tmp_path / name), names))
    assert seen == {name: str(tmp_path / name) for name in names}
    assert before == numba.config.CACHE_DIR
