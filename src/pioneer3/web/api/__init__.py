"""The HTTP API for scripts: one list of operations, from which routes and OpenAPI come.

=====================  ========================================================================
module                 contents
=====================  ========================================================================
routes                 routes to the operations of the API
robot_operations       the operations of the API on robots
navigation_operations  the operations of the API on places of the map
class_operations       the operations of the API on a class
body_operations        the operation of the API on the bodies of robots
access_operations      the operations of the API on sessions, invitations and tokens
camera_operations      the operations of the API on cameras
log_operations         the operations of the API on logs
operation              one operation of the API: declared once, served and documented from that
http_client            a client of the API on this computer, where no token is needed
types                  bodies of requests and answers of the API
=====================  ========================================================================
"""
