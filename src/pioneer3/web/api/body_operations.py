"""The operation of the API on the bodies of robots, from the description that URDF is made of."""

from collections.abc import Iterator, Mapping

from pioneer3.models import RobotModel, load_model, model_names
from pioneer3.models.description.solids import COLORS, LinkSolid, solids_of
from pioneer3.models.description.tree import Frames, FrameTree, Joint, tree_of
from pioneer3.web.access.middleware import ErrorResponse
from pioneer3.web.access.sessions import Role
from pioneer3.web.api import types
from pioneer3.web.api.operation import ApiRequest, operation
from pioneer3.web.page import Page


def get_body(request: ApiRequest) -> types.RobotBody | ErrorResponse:
    """Return the body of a type of robot: boxes and cylinders, as its URDF has them."""
    name = request.path["model"]
    model = _model(request.page, name)
    if model is None:
        return ErrorResponse(
            404, f"there is no model {name[:40]!r}; `pioneer3 model list` shows all"
        )
    return body_of(model)


def body_of(model: RobotModel) -> types.RobotBody:
    """Return the body of a robot of this type."""
    frames = Frames()
    tree = tree_of(model, frames)
    bumpers = model.front_bumpers, model.rear_bumpers
    solids = solids_of(model, tree, frames, bumpers=bumpers, laser=True)
    return types.RobotBody(model.name, tuple(_links(tree, solids)))


def _model(page: Page, name: str) -> RobotModel | None:
    """Return the model of a robot of the page, or a shipped one; `None` if there is none."""
    for view in page.robots.values():
        info = view.robot.supervisor.info
        if info is not None and info.model.name == name:
            return info.model
    return load_model(name) if name in model_names() else None


def _links(
    tree: FrameTree, solids: Mapping[str, tuple[LinkSolid, ...]]
) -> Iterator[types.DescribedLink]:
    fixed, wheels = tree.fixed_in_base(), {joint.child: joint for joint in tree.wheels}
    for name, parts in solids.items():
        wheel = wheels.get(name)
        x, y, z, yaw = (wheel.x, wheel.y, wheel.z, 0.0) if wheel else fixed[name]
        yield types.DescribedLink(
            at=(x, y, z),
            yaw=yaw,
            wheel=_side(wheel) if wheel else None,
            solids=tuple(_solid(part) for part in parts),
        )


def _side(wheel: Joint) -> types.Side:
    return "left" if wheel.y > 0 else "right"


def _solid(solid: LinkSolid) -> types.DescribedSolid:
    return types.DescribedSolid(
        shape="cylinder" if solid.is_round else "box",
        color=COLORS[solid.color],
        size=solid.size,
        at=solid.at,
        turned=solid.turned,
    )


BODIES = (operation("GET", "/api/models/{model}", get_body, Role.VIEWER, 404),)
