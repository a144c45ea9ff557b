"""The live page: its server, its messages, its HTTP API, and its files.

===========  =====================================================================================
module       contents
===========  =====================================================================================
live         `pioneer3 run`
app          routes: the page, its parts, its WebSocket and the API
book         the book: its pages by their names, and its place at a server
server       serves the page in the event loop that drives the robot
page         the state that all clients share: the robots, the world around them, and the clients
client       one client of the page, a WebSocket: its requests are carried out, its texts are sent
clients      the clients that are connected to a page, and their control of its robots
requests     messages from the page to the server: checked when decoded, told apart by `type`
messages     messages from the server to the page: JSON, one object each, told apart by `type`
modes        the forms of modes, as data for the page: made from the modes' descriptions
group        modes of several robots of the page
connections  limits the TCP connections of the page: silent and slow ones give way to new ones
websocket    uvicorn's WebSocket with bounded buffers and a rate limit for its messages
hosting      connects a page to several robots
map_editor   edits the map that robots of the page use: a draft, which is saved and then driven on
page_map     the map of a page: the one that it shows, and the one that its robots drive on
robot_view   one robot of the page: its control, and the messages that describe it
mapping      makes maps with a robot of the page, and goes on with the one in use
calibration  calibrates a robot of the page, a step at each request
navigation   takes a robot of the page to places of its map, along planned ways
details      details of a robot beyond its snapshots
editor       changes of the simulated world that drivers make on the page
world        the simulated world as pages see it: its map, its things by number, and their changes
solids       solids and heights of walls as pages are told of them
audience     clients that are sent the same texts: about all robots, or about one
control      control of a robot from pages and scripts: who may drive it, and with which input
scene        the surroundings of a robot: the map, and the robot's pose in it
broadcast    texts for all clients, each made once. A slow client gets the newest only
access       access to the page: pairing, roles, sessions, rate limits, host names, certificates
api          the HTTP API for scripts: one list of operations, from which routes and OpenAPI come
classroom    a class at the page: students drive a robot each, and the teacher sees to all of them
logs         the user's logs on a page of robots: their list, an excerpt that is kept, replays
replay       logs on the page as if they were live
===========  =====================================================================================
"""
