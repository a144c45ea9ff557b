"""The process that renders pictures: it alone loads OpenGL.

It is started as `python -m pioneer3.sim.physics.renderer` with MUJOCO_GL set, reads
:data:`Request` messages from its standard input and answers each on its standard output; before,
it says whether it can render at all. Whatever OpenGL does, the simulator lives on.
"""

import os
import sys
from dataclasses import dataclass
from io import BytesIO
from math import atan, cos, degrees, sin, tan
from typing import Any, BinaryIO, Final

import msgspec
import numpy as np
from msgspec import Struct
from numpy.typing import NDArray

from pioneer3.sim.physics.colors import DRAWN, TOUCHING

LENGTH: Final = 4
"""Bytes before each message: its length, the most significant byte first."""
NEAREST = 0.01
"""Distance below which nothing is seen [m]."""
FARTHEST = 200.0
"""Distance beyond which nothing is seen [m]."""
AMBIENT = 0.55
"""Ambient part of the only light, at the camera: colours are nearly those of the things."""
DIFFUSE = 0.45
"""Diffuse part of it."""


class LoadScene(Struct, tag=True):
    """Another world: the model of MuJoCo in its own binary format (MJB).

    The groups are those of each geom while no robot is hidden, 32-bit integers; the model's own
    ones change while robots are hidden.
    """

    model: bytes
    groups: bytes


class TakePicture(Struct, tag=True, kw_only=True):
    """A picture of the last world, by the camera of that name in the model.

    `qpos` is that of MuJoCo's data, `people` its `mocap_pos`, both 64-bit floats; the robots named
    in `hidden` are not to be seen. `pan` is to the left, `tilt` up, `view` the angle from the left
    edge to the right one [rad]; the quality is that of the JPEG, 1 to 95.
    """

    camera: str
    qpos: bytes
    people: bytes
    hidden: tuple[str, ...] = ()
    pan: float = 0.0
    tilt: float = 0.0
    view: float
    width: int
    height: int
    quality: int = 85


class Ready(Struct, tag=True):
    """The process can render."""

    backend: str


class PictureRequest(Struct, tag=True):
    """The picture that was asked for, as JPEG."""

    jpeg: bytes


class Failed(Struct, tag=True):
    """No picture, and the reason."""

    reason: str


Request = LoadScene | TakePicture
Answer = Ready | PictureRequest | Failed


def framed(message: Request | Answer) -> bytes:
    """Return a message as it is sent."""
    body = msgspec.msgpack.encode(message)
    return len(body).to_bytes(LENGTH, "big") + body


@dataclass(slots=True)
class _World:
    """The world that is drawn now, with its MuJoCo objects."""

    model: Any
    data: Any
    scene: Any
    context: Any
    groups: NDArray[np.int32]
    owners: NDArray[np.str_]


class SceneRenderer:
    """Draws one world after the other. All in one thread: the context belongs to it.

    Raises:
        ImportError: There is no OpenGL, or none without a screen.
        RuntimeError: The same.
    """

    def __init__(self) -> None:
        import mujoco
        from mujoco.rendering.classic.gl_context import GLContext

        self._mujoco: Any = mujoco
        self._size = (0, 0)
        self._make: Any = GLContext
        self._gl: Any = None
        self._world: _World | None = None
        self._rebind(320, 240)

    def load(self, world: LoadScene) -> None:
        """Draw another world from now on."""
        model = self._mujoco.MjModel.from_binary_path("world.mjb", {"world.mjb": world.model})
        model.geom_group[:] = np.frombuffer(world.groups, dtype=np.int32)
        self._show(model)

    def picture(self, asked: TakePicture) -> bytes:
        """Return a picture as JPEG; ValueError if no world was loaded, or it has no such camera."""
        from PIL import Image

        file = BytesIO()
        Image.fromarray(self.pixels(asked)).save(file, "JPEG", quality=asked.quality)
        return file.getvalue()

    def pixels(self, asked: TakePicture) -> NDArray[np.uint8]:
        """Return a picture, shape (height, width, 3); errors are those of :meth:`picture`."""
        if self._world is None:
            raise ValueError("no world was loaded")
        if asked.width > self._size[0] or asked.height > self._size[1]:
            self._rebind(asked.width, asked.height)
        mujoco, world = self._mujoco, self._world
        model, data = world.model, world.data
        number = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_CAMERA, asked.camera)
        if number < 0:
            raise ValueError(f"the world has no camera {asked.camera!r}")
        data.qpos[:] = np.frombuffer(asked.qpos)
        data.mocap_pos[:] = np.frombuffer(asked.people).reshape(-1, 3)
        mujoco.mju_mat2Quat(model.cam_quat[number], axes(asked.pan, asked.tilt).ravel())
        model.cam_fovy[number] = degrees(2 * atan(tan(asked.view / 2) * asked.height / asked.width))
        mujoco.mj_kinematics(model, data)
        mujoco.mj_comPos(model, data)
        mujoco.mj_camlight(model, data)
        hidden = np.isin(world.owners, asked.hidden) if asked.hidden else False
        model.geom_group[:] = np.where(hidden, TOUCHING, world.groups)
        camera, option = mujoco.MjvCamera(), mujoco.MjvOption()
        camera.type, camera.fixedcamid = mujoco.mjtCamera.mjCAMERA_FIXED, number
        option.geomgroup[:] = np.isin(np.arange(len(option.geomgroup)), DRAWN)
        option.sitegroup[:] = 0
        option.jointgroup[:] = option.tendongroup[:] = option.actuatorgroup[:] = 0
        mujoco.mjv_updateScene(
            model, data, option, None, camera, mujoco.mjtCatBit.mjCAT_ALL.value, world.scene
        )
        pixels = np.empty((asked.height, asked.width, 3), dtype=np.uint8)
        where = mujoco.MjrRect(0, 0, asked.width, asked.height)
        mujoco.mjr_render(where, world.scene, world.context)
        mujoco.mjr_readPixels(pixels, None, where, world.context)
        return np.flipud(pixels)

    def _rebind(self, width: int, height: int) -> None:
        """Make room for pictures of this size."""
        before, old = self._world, self._gl
        self._size = max(width, self._size[0]), max(height, self._size[1])
        if before is not None:
            before.context.free()
        if old is not None:
            old.free()
        self._gl = self._make(*self._size)
        self._gl.make_current()
        if before is not None:
            before.model.geom_group[:] = before.groups
            self._world = None
            self._show(before.model)

    def _show(self, model: Any) -> None:
        mujoco = self._mujoco
        if self._world is not None:
            self._world.context.free()
        visual = model.vis
        visual.quality.offsamples = visual.quality.shadowsize = 0
        visual.global_.offwidth, visual.global_.offheight = self._size
        visual.map.znear = NEAREST / model.stat.extent
        visual.map.zfar = FARTHEST / model.stat.extent
        visual.headlight.ambient[:], visual.headlight.diffuse[:] = AMBIENT, DIFFUSE
        visual.headlight.specular[:] = 0.0
        scene = mujoco.MjvScene(model, maxgeom=model.ngeom + model.nlight + 100)
        for flag in ("mjRND_SHADOW", "mjRND_REFLECTION", "mjRND_HAZE"):
            scene.flags[getattr(mujoco.mjtRndFlag, flag)] = 0
        context = mujoco.MjrContext(model, mujoco.mjtFontScale.mjFONTSCALE_50.value)
        mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_OFFSCREEN.value, context)
        names = [model.geom(number).name.partition("/")[0] for number in range(model.ngeom)]
        self._world = _World(
            model=model,
            data=mujoco.MjData(model),
            scene=scene,
            context=context,
            groups=model.geom_group.copy(),
            owners=np.array(names, dtype=np.str_),
        )


def axes(pan: float, tilt: float) -> NDArray[np.float64]:
    """Return the axes of a camera of MuJoCo, as columns, that looks along minus its z axis.

    It looks `pan` to the left of the robot's x axis, and `tilt` up [rad].
    """
    ahead = np.array([cos(tilt) * cos(pan), cos(tilt) * sin(pan), sin(tilt)])
    right = np.array([sin(pan), -cos(pan), 0.0])
    return np.stack([right, np.cross(right, ahead), -ahead], axis=1)


def serve(requests: BinaryIO, answers: BinaryIO, backend: str) -> None:
    """Answer requests until there are no more."""

    def say(answer: Answer) -> None:
        answers.write(framed(answer))
        answers.flush()

    try:
        renderer = SceneRenderer()
    except Exception as error:
        say(Failed(f"{type(error).__name__}: {error}"))
        return
    say(Ready(backend))
    decoder = msgspec.msgpack.Decoder(Request)
    while len(head := requests.read(LENGTH)) == LENGTH:
        message = decoder.decode(requests.read(int.from_bytes(head, "big")))
        if isinstance(message, LoadScene):
            renderer.load(message)
            continue
        try:
            answer: Answer = PictureRequest(renderer.picture(message))
        except ValueError as error:
            answer = Failed(str(error))
        say(answer)


def main() -> None:
    """Serve the simulator that has started this process."""
    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # libraries that print must not come between the answers
    serve(sys.stdin.buffer, answers, os.environ.get("MUJOCO_GL", ""))


if __name__ == "__main__":
    main()
