"""The operations of the API on places of the map."""

from typing import TYPE_CHECKING

from pioneer3.errors import ConfigError, PioneerError
from pioneer3.maps import LineMap
from pioneer3.web import messages
from pioneer3.web.access.middleware import ErrorResponse
from pioneer3.web.access.sessions import Role
from pioneer3.web.api import types
from pioneer3.web.api.operation import ApiRequest, operation

if TYPE_CHECKING:
    from pioneer3.nav.places import Destination


def list_places(request: ApiRequest) -> list[types.MapPlace] | ErrorResponse:
    """List the places of the map that have a name."""
    known = request.view.scene.map_now
    if refused := _impossible(request):
        return refused
    assert known is not None
    from pioneer3.nav.places import destination, places

    found = map(destination, places(known))
    return [types.MapPlace(each.name, each.x, each.y, each.heading) for each in found]


async def plan_way(request: ApiRequest, body: types.Place) -> messages.Way | ErrorResponse:
    """Return the way to a place of the map from where the robot is. Nothing drives."""
    return await _answer(request, body, drives=False)


async def goto_place(request: ApiRequest, body: types.Place) -> messages.Way | ErrorResponse:
    """Drive to a place of the map along a planned way, and return that way.

    Takes control if it is free; it is yours while the robot is on its way. `mode` says how that
    ended; `navigation` what is left of it.
    """
    return await _answer(request, body, drives=True)


def get_navigation(request: ApiRequest) -> messages.Navigation | ErrorResponse:
    """Return whether the robot is sure of its place on the map, and the rest of its way."""
    if refused := _impossible(request):
        return refused
    state = request.view.navigation.state
    return state or messages.Navigation(
        request.view.number, sure=False, reason="nobody has asked for a way yet"
    )


async def _answer(
    request: ApiRequest, body: types.Place, *, drives: bool
) -> messages.Way | ErrorResponse:
    by_name, by_numbers = body.name is not None, body.x is not None and body.y is not None
    if by_name == by_numbers:
        return ErrorResponse(400, "give the name of a place, or x and y")
    if refused := _impossible(request):
        return refused
    if drives and (taken := request.view.control.take(request.caller)):
        return ErrorResponse(409, taken.text)
    try:
        return await request.view.navigation.answer(
            request.caller, lambda known: _place(known, body), body.speed, drives=drives
        )
    except ConfigError as error:
        return ErrorResponse(404, str(error))
    except PioneerError as error:
        return ErrorResponse(409, str(error))


def _impossible(request: ApiRequest) -> ErrorResponse | None:
    reason = request.view.navigation.impossible
    return ErrorResponse(409, reason) if reason else None


def _place(known: LineMap, body: types.Place) -> "Destination":
    from pioneer3.nav.places import Destination, find_place

    if body.name is not None:
        return find_place(known, body.name)
    assert body.x is not None
    assert body.y is not None
    return Destination(x=body.x, y=body.y, heading=body.heading)


ROBOT = "/api/robots/{robot}"
VIEWER, STUDENT = Role.VIEWER, Role.STUDENT
NAVIGATION = (
    operation("GET", f"{ROBOT}/places", list_places, VIEWER, 404, 409),
    operation("GET", f"{ROBOT}/navigation", get_navigation, VIEWER, 404, 409),
    operation("POST", f"{ROBOT}/way", plan_way, STUDENT, 404, 409),
    operation("POST", f"{ROBOT}/goto_place", goto_place, STUDENT, 404, 409),
)
