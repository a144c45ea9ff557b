"""Compiled kernels and where they are kept."""

import time
from concurrent.futures import ThreadPoolExecutor
from errno import ENOSPC
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import pytest

from pioneer3 import jit
from pioneer3.jit import KernelCache

numba = pytest.importorskip("numba")


def some(name: str) -> Any:
    function = eval("lambda: 1")
    function.__name__ = name
    return jit.kernel(function)


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

    monkeypatch.setattr(numba, "njit", njit)
    before = numba.config.CACHE_DIR
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    caches = {f"kernel{n}": KernelCache(tmp_path / str(n)) for n in range(8)}
    with ThreadPoolExecutor(8) as pool:
        list(pool.map(lambda name: jit._compiled(some(name), caches[name]), caches))
    assert seen == {name: str(kept.directory) for name, kept in caches.items()}
    assert before == numba.config.CACHE_DIR


def full(**_: object) -> None:
    raise OSError(ENOSPC, "No space left on device")


@pytest.fixture(params=["read-only", "full"])
def spoiled(
    request: pytest.FixtureRequest, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> KernelCache:
    """A cache that nothing can be written to."""
    folder = tmp_path / "cache"
    if request.param == "full":
        monkeypatch.setattr(jit, "TemporaryFile", full)
    else:
        folder.write_text("a file where the folder should be")
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(folder))
    return KernelCache(tmp_path)


def test_kernels_are_compiled_without_a_cache_where_none_can_be_written(
    spoiled: KernelCache, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[bool] = []

    def njit(*, cache: bool, **_: object) -> Any:
        asked.append(cache)
        return lambda function: function

    monkeypatch.setattr(numba, "njit", njit)
    jit.fast(some("kernel"), spoiled)
    with spoiled.compiling():
        pass
    assert asked == [False]
    assert not spoiled.is_complete


def test_a_cache_that_cannot_be_written_is_told_once(
    spoiled: KernelCache, tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    assert not spoiled.can_keep
    assert not KernelCache(tmp_path / "others").can_keep
    (told,) = caplog.messages
    assert told.startswith(f"{spoiled.directory.parent}: ")
    assert "NUMBA_CACHE_DIR" in told


def test_a_cache_is_complete_once_that_is_noted(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    assert not KernelCache(tmp_path).is_complete
    with KernelCache(tmp_path).compiling():
        assert not KernelCache(tmp_path).is_complete
    assert KernelCache(tmp_path).is_complete


@pytest.mark.skipif(find_spec("fcntl") is None, reason="Windows has no such locks")
def test_of_several_that_need_the_same_kernels_one_compiles_them(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    compiled: list[int] = []
    inside: list[int] = []

    def start(number: int) -> int:
        with KernelCache(tmp_path).compiling(lambda: compiled.append(number)):
            inside.append(number)
            time.sleep(0.02)  # the others come
            if compiled != [number]:
                return 0
            assert inside == [number]
        return 1

    with ThreadPoolExecutor(4) as pool:
        assert sum(pool.map(start, range(4))) == 1
    assert sorted(inside) == [0, 1, 2, 3]


def test_who_does_not_come_to_an_end_leaves_the_rest_to_the_next(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    begun: list[str] = []
    with pytest.raises(KeyboardInterrupt), KernelCache(tmp_path).compiling():
        raise KeyboardInterrupt
    with KernelCache(tmp_path).compiling(lambda: begun.append("again")):
        pass
    with KernelCache(tmp_path).compiling(lambda: begun.append("once more")):
        pass
    assert begun == ["again"]
