"""The HTTP API for scripts: one list of operations, from which routes and OpenAPI come.

=====================  ========================================================================
module                 contents
=====================  ========================================================================
routes                 routes to the operations of the API
robot_operations       the operations of the API on robots, their cameras and their bodies
navigation_operations  the operations of the API on places of the map
class_operations       the operations of the API on a class
access_operations      the operations of the API on sessions, invitations and tokens
log_operations         the operations of the API on logs
operation              one operation of the API: declared once, served and documented from that
http_client            a client of the API on this computer, where no token is needed
types                  bodies of requests and answers of the API
=====================  ========================================================================
"""
