"""Asynchronous objects without `await`, for scripts and notebooks.

Nothing is written twice: a facade calls what it stands for on the event loop of a thread. There a
coroutine is awaited, an asynchronous iterator becomes an iterator, a context manager is entered and
left, and what is itself asynchronous, such as a device, becomes a facade too.
"""

import asyncio
import inspect
import os
import threading
from collections.abc import AsyncGenerator, AsyncIterator, Callable, Coroutine, Hashable, Iterator
from concurrent.futures import wait
from contextlib import AbstractContextManager, contextmanager
from functools import cache, wraps
from types import GenericAlias
from typing import Any, Concatenate, ParamSpec, TypeVar, cast, get_args, get_origin, overload

P = ParamSpec("P")
T = TypeVar("T")

CLOSE_PATIENCE = 3.0
"""For the end of a session [s]: 1 s to stand, 0.5 s for the farewell, 0.5 s to close the link."""


class LoopThread:
    """An event loop in a thread of its own, for the threads of one process."""

    def __init__(self) -> None:
        self.loop = asyncio.new_event_loop()
        self._thread = threading.Thread(target=self.loop.run_forever, name="pioneer3", daemon=True)
        self._process = os.getpid()
        self._thread.start()

    @property
    def is_ours(self) -> bool:
        """Whether this process started the thread; a fork has only a picture of it."""
        return self._process == os.getpid()

    def wait(self, coroutine: Coroutine[Any, Any, T]) -> T:
        """Run `coroutine` on the loop; an interrupt of this thread cancels it there.

        Raises:
            RuntimeError: the loop has ended, or belongs to the process that forked this one.
        """
        if self.loop.is_closed() or not self.is_ours:
            coroutine.close()
            if self.is_ours:
                raise RuntimeError("this robot has been closed; connect again")
            raise RuntimeError("the process that forked this one has the robot; connect again")
        future = asyncio.run_coroutine_threadsafe(coroutine, self.loop)
        try:
            return future.result()
        except BaseException:
            future.cancel()
            raise

    def call(self, function: Callable[[], T | Coroutine[Any, Any, T]]) -> T:
        """Call `function` on the loop; await its result if that is a coroutine."""

        async def call() -> T:
            result = function()
            return await result if inspect.iscoroutine(result) else cast("T", result)

        return self.wait(call())

    def end(self, last: Coroutine[Any, Any, None]) -> None:
        """Run `last`, then end the loop and its thread; an interrupt has to wait for that."""
        ending = asyncio.run_coroutine_threadsafe(last, self.loop)
        try:
            wait([ending], CLOSE_PATIENCE)
        finally:
            wait([ending], CLOSE_PATIENCE)
            self.loop.call_soon_threadsafe(self.loop.stop)
            self._thread.join(CLOSE_PATIENCE)
            if not self._thread.is_alive():
                self.loop.close()
        ending.result(0)


class Facade:
    """Stands for an asynchronous object; each of its public names does the same, and waits."""

    def __init__(self, target: Any, thread: LoopThread) -> None:
        self._target, self._thread = target, thread

    def _read(self, name: str) -> Any:
        return adapted(self._thread.call(lambda: getattr(self._target, name)), self._thread)


class MadeFacade(Facade):
    """A facade with the members of a class, and the attributes of an object besides."""

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        return self._read(name)

    def __dir__(self) -> list[str]:
        return sorted({*object.__dir__(self), *(n for n in vars(self._target) if n[0] != "_")})


@cache
def facade_of(kind: type) -> type[Facade]:
    """Return the class of facades of `kind`, with its names, signatures and docstrings."""
    members: dict[str, object] = {"__doc__": kind.__doc__}
    for name in (name for name in dir(kind) if not name.startswith("_")):
        member = getattr(kind, name)
        members[name] = blocking(member) if inspect.isfunction(member) else _property(name, member)
    if inspect.isfunction(call := vars(kind).get("__call__")):
        members["__call__"] = blocking(call)
    return type(f"Blocking{kind.__name__}", (MadeFacade,), members)


@overload
def blocking(
    method: Callable[Concatenate[Any, P], Coroutine[Any, Any, T]],
) -> Callable[Concatenate[Any, P], T]: ...
@overload
def blocking(
    method: Callable[Concatenate[Any, P], AsyncIterator[T]],
) -> Callable[Concatenate[Any, P], Iterator[T]]: ...
@overload
def blocking(
    method: Callable[Concatenate[Any, P], T],
) -> Callable[Concatenate[Any, P], T]: ...
def blocking(method: Callable[..., Any]) -> Callable[..., Any]:
    """Return the method of a facade that does as `method` does."""

    @wraps(method)
    def call(self: Facade, *arguments: Any, **options: Any) -> Any:
        result = self._thread.call(lambda: method(self._target, *arguments, **options))
        return adapted(result, self._thread)

    signature = inspect.signature(method)
    if _iterates(signature.return_annotation):
        items = get_args(signature.return_annotation)[:1]
        signature = signature.replace(return_annotation=GenericAlias(Iterator, items))
    call.__signature__ = signature  # type: ignore[attr-defined]
    return call


def _property(name: str, member: Any) -> property:
    return property(lambda self: self._read(name), doc=inspect.getdoc(member))


def adapted(value: Any, thread: LoopThread) -> Any:
    """Return `value` as a program without an event loop can use it."""
    if isinstance(value, AsyncIterator):
        return _iterate(value, thread)
    if isinstance(value, AbstractContextManager):
        return _within(value, thread)
    kind = cast("Hashable", type(value))
    return facade_of(kind)(value, thread) if _is_asynchronous(kind) else value


def _iterate(values: AsyncIterator[T], thread: LoopThread) -> Iterator[T]:
    async def following() -> list[T]:
        async for value in values:
            return [value]
        return []

    try:
        while value := thread.wait(following()):
            yield value[0]
    finally:
        # not waited for: the thread of the loop may be the one that clears up
        if isinstance(values, AsyncGenerator) and thread.is_ours and thread.loop.is_running():
            asyncio.run_coroutine_threadsafe(_close(values), thread.loop)


async def _close(values: AsyncGenerator[Any, None]) -> None:
    await values.aclose()


@contextmanager
def _within(context: AbstractContextManager[T], thread: LoopThread) -> Iterator[T]:
    entered = thread.call(context.__enter__)
    try:
        yield entered
    finally:
        thread.call(lambda: context.__exit__(None, None, None))


@cache
def _is_asynchronous(kind: type) -> bool:
    """Whether objects of this class of ours have anything to wait for."""
    return kind.__module__.startswith("pioneer3.") and any(
        inspect.iscoroutinefunction(member)
        or _iterates(inspect.signature(member).return_annotation)
        for name, member in inspect.getmembers(kind, inspect.isfunction)
        if not name.startswith("_")
    )


def _iterates(annotation: Any) -> bool:
    origin = get_origin(annotation)
    return isinstance(origin, type) and issubclass(origin, AsyncIterator)
