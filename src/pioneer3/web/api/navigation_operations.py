"""The operations of the API on places of the map."""

from collections.abc import Awaitable

from pioneer3.errors import ConfigError, PioneerError
from pioneer3.nav.places import Destination, destination, find_place, places
from pioneer3.web import messages
from pioneer3.web.access.middleware import ErrorResponse
from pioneer3.web.access.sessions import Role
from pioneer3.web.api import types
from pioneer3.web.api.operation import ApiRequest, operation


def list_places(request: ApiRequest) -> list[types.MapPlace] | ErrorResponse:
    """List the places of the map that have a name."""
    known = request.view.scene.map_now
    if refused := _impossible(request):
        return refused
    assert known is not None
    found = map(destination, places(known))
    return [types.MapPlace(each.name, each.x, each.y, each.heading) for each in found]


async def plan_way(
    request: ApiRequest, body: types.WantedPlace
) -> messages.PlannedWay | ErrorResponse:
    """Return the way to a place of the map from where the robot is. Nothing drives."""
    place = _place(request, body)
    if isinstance(place, ErrorResponse):
        return place
    return await _answered(request.view.navigation.plan(place, body.speed))


async def goto_place(
    request: ApiRequest, body: types.WantedPlace
) -> messages.PlannedWay | ErrorResponse:
    """Drive to a place of the map along a planned way, and return that way.

    Takes control if it is free; it is yours while the robot is on its way. `mode` says how that
    ended; `navigation` what is left of it.
    """
    place = _place(request, body)
    if isinstance(place, ErrorResponse):
        return place
    if taken := request.view.control.take(request.caller):
        return ErrorResponse(409, taken.text)
    return await _answered(request.view.navigation.drive(request.caller, place, body.speed))


def get_navigation(request: ApiRequest) -> messages.Navigation | ErrorResponse:
    """Return whether the robot is sure of its place on the map, and the rest of its way."""
    if refused := _impossible(request):
        return refused
    state = request.view.navigation.state
    return state or messages.Navigation(
        request.view.number, sure=False, reason="nobody has asked for a way yet"
    )


def _place(request: ApiRequest, body: types.WantedPlace) -> Destination | ErrorResponse:
    """Return the place of a request, or the refusal."""
    if refused := _impossible(request):
        return refused
    known = request.view.scene.map_now
    assert known is not None
    try:
        match body:
            case types.WantedPlace(name=str(name), x=None, y=None):
                return find_place(known, name)
            case types.WantedPlace(name=None, x=float(x), y=float(y)):
                return Destination(x=x, y=y, heading=body.heading)
    except ConfigError as error:
        return ErrorResponse(404, str(error))
    return ErrorResponse(400, "give the name of a place, or x and y")


async def _answered(asked: Awaitable[messages.PlannedWay]) -> messages.PlannedWay | ErrorResponse:
    try:
        way = await asked
    except PioneerError as error:
        return ErrorResponse(409, str(error))
    if way.refusal:
        return ErrorResponse(409, way.refusal)
    return way


def _impossible(request: ApiRequest) -> ErrorResponse | None:
    reason = request.view.navigation.impossible
    return ErrorResponse(409, reason) if reason else None


ROBOT = "/api/robots/{robot}"
VIEWER, STUDENT = Role.VIEWER, Role.STUDENT
NAVIGATION = (
    operation("GET", f"{ROBOT}/places", list_places, VIEWER, 404, 409),
    operation("GET", f"{ROBOT}/navigation", get_navigation, VIEWER, 404, 409),
    operation("POST", f"{ROBOT}/way", plan_way, STUDENT, 404, 409),
    operation("POST", f"{ROBOT}/goto_place", goto_place, STUDENT, 404, 409),
)
