"""Short drives to and fro, found by a search over places and headings."""

from math import cos, floor, inf, isnan, pi, sin, sqrt

from pioneer3.arrays import Float, Float32, Int32
from pioneer3.jit import inlined, kernel
from pioneer3.nav.kernels.arcs import gap_to


@inlined
def _state_of(x: float, y: float, theta: float, middle: Float, cell: float, sizes: Int32) -> int:
    """Return the number of the state of a pose; -1 outside."""
    side, headings = sizes[0], sizes[1]
    column = floor((x - middle[0]) / cell) + side // 2
    row = floor((y - middle[1]) / cell) + side // 2
    if column < 0 or row < 0 or column >= side or row >= side:
        return -1
    turned = floor(theta / (2 * pi) * headings + 0.5) % headings
    return int((row * side + column) * headings + turned)


@inlined
def _room(x: float, y: float, theta: float, outline: Float, points: Float) -> float:
    """Return the gap between a robot and the nearest of `points`: x, y, radius (N, 3) [m]."""
    c, s = cos(theta), sin(theta)
    least = inf
    for i in range(len(points)):
        dx, dy = points[i, 0] - x, points[i, 1] - y
        gap = gap_to(c * dx + s * dy, c * dy - s * dx, outline[0], outline[1], outline[2])
        least = min(least, gap - points[i, 2])
    return least


@inlined
def _around(x: float, y: float, points: Float) -> float:
    """Return the distance between a place and the nearest of `points` (N, 3) [m]."""
    least = inf
    for i in range(len(points)):
        dx, dy = points[i, 0] - x, points[i, 1] - y
        least = min(least, sqrt(dx * dx + dy * dy) - points[i, 2])
    return least


@inlined
def _fits(
    x: float, y: float, theta: float, outline: Float, points: Float, around: float, slack: float
) -> bool:
    """Return whether a robot keeps its least gap; `around` is that of its cell's middle [m]."""
    front, rear, half, least = outline[0], outline[1], outline[2], outline[3]
    far = max(front, rear)
    reach = sqrt(far * far + half * half) + least
    if around - slack >= reach:
        return True
    if around + slack < min(half, front, rear) + least:
        return False
    c, s = cos(theta), sin(theta)
    for i in range(len(points)):
        dx, dy = points[i, 0] - x, points[i, 1] - y
        apart = least + points[i, 2]
        near = dx * dx + dy * dy < (reach + points[i, 2]) ** 2
        if near and gap_to(c * dx + s * dy, c * dy - s * dx, front, rear, half) < apart:
            return False
    return True


@inlined
def _push(heap: Int32, keys: Float32, size: int, state: int) -> int:
    """Put a state into the heap, which has `size`; return the new size. A state may be twice in."""
    at = size
    while at > 0:
        above = (at - 1) // 2
        if keys[heap[above]] <= keys[state]:
            break
        heap[at] = heap[above]
        at = above
    heap[at] = state
    return size + 1


@inlined
def _pop(heap: Int32, keys: Float32, size: int) -> int:
    """Take the top off the heap, which has `size`; return the new size."""
    state = heap[size - 1]
    at = 0
    while True:
        below = 2 * at + 1
        if below >= size - 1:
            break
        if below + 1 < size - 1 and keys[heap[below + 1]] < keys[heap[below]]:
            below += 1
        if keys[heap[below]] >= keys[state]:
            break
        heap[at] = heap[below]
        at = below
    heap[at] = state
    return size - 1


@kernel
def manoeuvre(
    start: Float,
    moves: Float,
    outline: Float,
    points: Float,
    ways: Float,
    to_go: Float32,
    frame: Float,
    sizes: Int32,
    poses: Float,
    costs: Float32,
    keys: Float32,
    before: Int32,
    heap: Int32,
    arounds: Float,
    asides: Float,
    progress: Int32,
) -> int:
    """Search for the cheapest drive to a pose where the robot is out of the ways of others.

    Without such ways: to a pose from which its own way goes on without a manoeuvre. The search
    ends after some states; called with the same arrays once more, it goes on.

    Args:
        start: x, y [m] and heading [rad] in the map's frame, shape (3,).
        moves: Way [m], negative backwards, turn [rad] and cost of each move, shape (M, 3).
        outline: Front, rear, half of the width, least gap, the gap around its middle with which it
            may turn anywhere, the cost to go that the drive has to get below, and the gap between
            the robot and the ways of others in the end [m], shape (7,).
        points: Obstacles in the map's frame: x, y, radius [m], shape (N, 3).
        ways: Points of the ways of others, with 0 for a radius [m], shape (K, 3).
        to_go: Cost to go [m], shape (H, W); `inf` where the robot must not be.
        frame: x, y of its lower left corner, side of its cells, side of a state's place [m], (4,).
        sizes: Places along a side of the window around the start, headings, the number of states
            after which the search gives up, and the number of states in this call, shape (4,).
        poses: Work space: pose of each state, shape (S, 3).
        costs: Filled with `inf`: the cheapest cost of each state, shape (S,).
        keys: Work space: cost and cost to go, shape (S,).
        before: Filled with -1: the state before each, shape (S,); once it is settled,
            `-2 - before`.
        heap: Work space, shape (4 S,).
        arounds: Filled with NaN: distance between each place and the nearest obstacle [m],
            shape (P,).
        asides: Work space: the same of the ways of others, shape (P,).
        progress: Filled with 0: size of the heap, 0 once the search is over, and number of states
            that are settled, shape (2,).

    Returns:
        The last state of the drive, from which `before` leads back; -1 if none was found yet.
    """
    cell, side = frame[3], sizes[0]
    inner, slack = min(outline[0], outline[1], outline[2]), sqrt(0.5) * cell
    first = _state_of(start[0], start[1], start[2], start, cell, sizes)
    size, settled = progress[0], progress[1]
    if settled == 0:
        poses[first] = start
        costs[first], keys[first], before[first] = 0.0, 0.0, first
        size = _push(heap, keys, size, first)
    most = min(settled + sizes[3], sizes[2])
    while size > 0 and settled < most:
        state = heap[0]
        size = _pop(heap, keys, size)
        if before[state] < -1:
            continue
        x, y, theta = poses[state, 0], poses[state, 1], poses[state, 2]
        before[state] = -2 - before[state]
        settled += 1
        if len(ways) > 0:
            possible = state == first or asides[state // sizes[1]] >= outline[6]
            if possible and _room(x, y, theta, outline, ways) >= outline[6]:
                return int(state)
        else:
            row, column = floor((y - frame[1]) / frame[2]), floor((x - frame[0]) / frame[2])
            if to_go[row, column] < outline[5] and _around(x, y, points) >= outline[4]:
                return int(state)
        for move in range(len(moves)):
            way, turn = moves[move, 0], moves[move, 1]
            middle = theta + turn / 2.0
            nx, ny, heading = x + way * cos(middle), y + way * sin(middle), theta + turn
            other = _state_of(nx, ny, heading, start, cell, sizes)
            if other < 0 or before[other] < -1:
                continue
            row, column = floor((ny - frame[1]) / frame[2]), floor((nx - frame[0]) / frame[2])
            if row < 0 or column < 0 or row >= to_go.shape[0] or column >= to_go.shape[1]:
                continue
            cost = costs[state] + moves[move, 2]
            if cost >= costs[other] or to_go[row, column] == inf:
                continue
            place = other // sizes[1]
            if isnan(arounds[place]):
                px = start[0] + (place % side - side // 2 + 0.5) * cell
                py = start[1] + (place // side - side // 2 + 0.5) * cell
                arounds[place] = _around(px, py, points)
                asides[place] = _around(px, py, ways) + slack - inner  # it is no farther from them
            if not _fits(nx, ny, heading, outline, points, arounds[place], slack):
                continue
            if size >= len(heap):
                progress[0] = 0
                return -1
            poses[other, 0], poses[other, 1], poses[other, 2] = nx, ny, heading
            costs[other], before[other] = cost, state
            left = to_go[row, column]
            if len(ways) > 0:
                left = max(0.0, outline[6] - asides[place])
            keys[other] = cost + left
            size = _push(heap, keys, size, other)
    progress[0], progress[1] = size if settled < sizes[2] else 0, settled
    return -1
