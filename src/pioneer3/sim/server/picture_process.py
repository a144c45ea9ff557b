"""The process that renders the pictures of all cameras of a simulation."""

import asyncio
import os
import sys
from asyncio.subprocess import PIPE, Process
from contextlib import suppress
from typing import Final, NamedTuple

import msgspec
import numpy as np

from pioneer3.distribution import how_to_get
from pioneer3.errors import DeviceError
from pioneer3.names import printable
from pioneer3.sim.physics.dynamics import GL, Instant
from pioneer3.sim.physics.renderer import (
    LENGTH,
    Answer,
    Failed,
    LoadScene,
    PictureRequest,
    Ready,
    TakePicture,
    framed,
)
from pioneer3.sim.physics.scene import Scene

MODULE: Final = "pioneer3.sim.physics.renderer"
PLATFORM: Final = "PYOPENGL_PLATFORM"
"""PyOpenGL loads what this variable says; it has to be the same as MUJOCO_GL."""
PACKAGES: Final = "libegl1 libgl1-mesa-dri"
"""Debian's, for OpenGL without a screen."""
BACKENDS: Final = ("egl", "osmesa") if sys.platform == "linux" else ("",)
"""Backends of OpenGL, in the order of trying; elsewhere MuJoCo chooses."""
START_PATIENCE = 20.0
"""For the process to load [s]; it takes 0.6 on a machine that is not busy."""
PICTURE_PATIENCE = 10.0
CLOSE_PATIENCE = 1.0
LONGEST_ANSWER = 64 << 20
LAST_WORDS = 4 << 10
"""Kept of what the process says on its standard error [bytes]."""


class RenderFailure(NamedTuple):
    """Why the process does not render with one OpenGL; maybe `told` by the process itself."""

    reason: str
    told: bool


class PictureProcess:
    """Renders one picture after the other, by OpenGL in a process of its own.

    The `backend` is the OpenGL in use; empty before :meth:`start`.
    """

    def __init__(self) -> None:
        self.backend = ""
        self._process: Process | None = None
        self._scene: Scene | None = None
        self._decoder: msgspec.msgpack.Decoder[Answer] = msgspec.msgpack.Decoder(Answer)
        self._busy = asyncio.Lock()
        self._said = b""
        self._listening: asyncio.Task[None] | None = None

    async def start(self) -> None:
        """Start the process with the first OpenGL that works; a running one is ended.

        Raises:
            DeviceError: None works; the message says what to install.
        """
        await self.close()
        failures = []
        for backend in BACKENDS:
            failure = await self._try(backend)
            if failure is None:
                return
            reason = f"{backend}: {failure.reason}" if backend else failure.reason
            failures.append(failure._replace(reason=reason))
        raise DeviceError(_advice(failures))

    async def picture(self, instant: Instant, asked: TakePicture) -> bytes:
        """Return a picture of the world at `instant`, as JPEG.

        Raises:
            DeviceError: The process does not run, or does not answer.
        """
        async with self._busy:
            try:
                async with asyncio.timeout(PICTURE_PATIENCE):
                    answer = await self._ask(instant, asked)
            except TimeoutError:
                await self.close()
                raise DeviceError(f"no picture within {PICTURE_PATIENCE:g} s") from None
            except BaseException:
                await self.close()  # what it says next would be the answer to this
                raise
        if isinstance(answer, PictureRequest):
            return answer.jpeg
        raise DeviceError(answer.reason if isinstance(answer, Failed) else "no picture")

    async def close(self) -> None:
        """End the process."""
        process, self._process, self._scene = self._process, None, None
        listening, self._listening = self._listening, None
        if process is None:
            return
        assert process.stdin is not None
        assert listening is not None
        process.stdin.close()
        try:
            async with asyncio.timeout(CLOSE_PATIENCE):
                await process.wait()
        except TimeoutError:
            with suppress(ProcessLookupError):
                process.kill()
            await process.wait()
        await listening

    async def _try(self, backend: str) -> RenderFailure | None:
        """Start the process; return why it cannot render, or `None`."""
        environment = {name: value for name, value in os.environ.items() if name != PLATFORM}
        environment |= {GL: backend}
        self._process = await asyncio.create_subprocess_exec(
            *(sys.executable, "-P", "-m", MODULE),  # -P: modules in the working folder are not ours
            stdin=PIPE,
            stdout=PIPE,
            stderr=PIPE,
            env=environment,
            start_new_session=True,  # Ctrl-C is for the simulator, which ends it
        )
        assert self._process.stderr is not None
        self._said = b""
        self._listening = asyncio.create_task(self._listen(self._process.stderr))
        try:
            async with asyncio.timeout(START_PATIENCE):
                answer = await self._read()
        except (DeviceError, TimeoutError) as error:
            await self.close()
            reason = str(error) or f"nothing within {START_PATIENCE:g} s"
            return RenderFailure(self._last_line or reason, told=False)
        except BaseException:
            await self.close()
            raise
        if isinstance(answer, Ready):
            self.backend = answer.backend
            return None
        await self.close()
        if isinstance(answer, Failed):
            return RenderFailure(answer.reason, told=True)
        return RenderFailure("it says nothing", told=False)

    async def _listen(self, errors: asyncio.StreamReader) -> None:
        while said := await errors.read(LAST_WORDS):
            self._said = (self._said + said)[-LAST_WORDS:]

    @property
    def _last_line(self) -> str:
        """The last line on the standard error of the process; empty without one."""
        lines = self._said.decode(errors="replace").strip().splitlines()
        return printable(lines[-1]) if lines else ""

    async def _ask(self, instant: Instant, asked: TakePicture) -> Answer:
        process = self._process
        if process is None:
            raise DeviceError("nothing renders pictures")
        assert process.stdin is not None
        if instant.scene is not self._scene:
            process.stdin.write(framed(_loading(instant.scene)))
            self._scene = instant.scene
        process.stdin.write(framed(asked))
        try:
            await process.stdin.drain()
        except OSError as error:
            raise DeviceError(f"what renders pictures has ended: {error}") from None
        return await self._read()

    async def _read(self) -> Answer:
        assert self._process is not None
        assert self._process.stdout is not None
        reader = self._process.stdout
        try:
            length = int.from_bytes(await reader.readexactly(LENGTH), "big")
            if length > LONGEST_ANSWER:
                raise DeviceError("what renders pictures talks nonsense")
            return self._decoder.decode(await reader.readexactly(length))
        except (asyncio.IncompleteReadError, OSError, msgspec.DecodeError):
            raise DeviceError("what renders pictures has ended") from None


def _advice(failures: list[RenderFailure]) -> str:
    """Return one line about what is missing, and what to do."""
    if any("OpenGL" in reason and "No module" in reason for reason, _ in failures):
        return f"no camera pictures: {how_to_get('physics')}"
    why = "; ".join(" ".join(reason.split())[:100] for reason, _ in failures)
    if not any(told for _, told in failures):
        return f"no camera pictures, all else works: what renders them does not start ({why})"
    if sys.platform != "linux":
        return f"no camera pictures: OpenGL does not work here ({why})"
    return (
        "no camera pictures, all else works: OpenGL without a screen is missing; on Debian run: "
        f"sudo apt-get install -y {PACKAGES} ({why})"
    )


def _loading(scene: Scene) -> LoadScene:
    """Return the message that carries a world."""
    import mujoco

    buffer = np.zeros((mujoco.mj_sizeModel(scene.model), 1), dtype=np.uint8)
    mujoco.mj_saveModel(scene.model, None, buffer)
    return LoadScene(buffer.tobytes(), scene.groups.astype(np.int32).tobytes())
