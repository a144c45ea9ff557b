"""The `pioneer3` command: parse, call one library function, print.

================  ==================================================================================
module            contents
================  ==================================================================================
main              the command line: its commands, and the exit codes of errors
ros2              `pioneer3 ros2`
ros2_check        `pioneer3 ros2 check`
ros2_check_table  the report of `pioneer3 ros2 check` in a terminal
ros2_bridge       `pioneer3 ros2 bridge`
ros2_network      the options that the commands of ROS 2 have in common
fleet             `pioneer3 fleet`: the robots of a fleet file; its commands are listed at the end
fleet_tables      `pioneer3 fleet list`
fleet_network     `pioneer3 fleet hosts`, `ssh-config` and `aliases`
fleet_group       `pioneer3 fleet form`, `follow-leader` and `spread`
fleet_drive       `pioneer3 fleet drive` and `pioneer3 fleet stop`: all robots at one keyboard
fleet_ros         how commands for a fleet reach robots over ROS 1 and ROS 2
fleet_work        `pioneer3 fleet run` and its kin: work on the computers of many robots at once
fleet_output      output of work on many robots: lines that begin with a robot's name, and a summary
fleet_discover    `pioneer3 fleet discover`
monitor           `pioneer3 monitor`
screen            the monitor's screen
calibrate         `pioneer3 calibrate`: the errors of odometry and of a laser's place
map               `pioneer3 map`: make maps, look at maps and worlds, check them, convert them
map_build         `pioneer3 map build`
map_drawing       a map as characters: braille dots for lines, signs and names for places
ros1              `pioneer3 ros1`
ros_arguments     the words of ROS 2 in a command line, as one
topic_demos       the demos on topics, from any computer
sonar             `pioneer3 sonar`
topic_driving     drives a robot on topics by keys or by a mode; the same in ROS 1 and ROS 2
diagnosis         `pioneer3 info`, `doctor` and `find-port`
docs              `pioneer3 docs`: the book in a browser
tables            tables of a robot, a diagnosis and a list of ports for a terminal
model             `pioneer3 model`
robot             `pioneer3 robot`: the own file of a robot
config            `pioneer3 config`: the settings of the controller, and their backups
laser             `pioneer3 laser`: a laser range finder alone, without a robot
log               `pioneer3 log`: the logs of what robots did
log_convert       `pioneer3 log convert`: logs for other programs
replay            `pioneer3 replay`: logs on the page
log_verify        `pioneer3 log verify`: today's driver over the bytes of a log
log_why           `pioneer3 log why`
log_plot          `pioneer3 log plot`: a run as a picture, or in the terminal
log_stats         `pioneer3 log stats`
goto              `pioneer3 goto` and `patrol`: to places of the map by their names, or to points
places            places of a map on the command line: a name, or numbers
drive             `pioneer3 drive`
sim               `pioneer3 sim`
sim_like          the robot of `sim --like`, found by its own file or a log
run               `pioneer3 run`
motion            `pioneer3 move` and `turn`, and a command for each mode
live              shows a robot while a motion or mode drives it
demo              `pioneer3 demo`
classroom         `pioneer3 class`
bridge            `pioneer3 bridge`
access            `pioneer3 access`: who may use the page of a robot that runs on this computer
setup             `pioneer3 setup`: prepares this computer for robots and lasers
process           the process of a command: its event loop, its signals, its output
terminal          the terminal of a command, through rich
aria_options      options with one dash, as ARIA and MobileSim have them
options           options that several commands share
================  ==================================================================================
"""
