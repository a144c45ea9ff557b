"""From keys and sticks to commands.

==============  ===================================================================================
module          contents
==============  ===================================================================================
terminal        keys from a terminal as they are pressed; the terminal is restored on every way out
several         one keyboard for several robots: who is chosen, and which keys reach whom
keyboard_drive  joins a keyboard to a robot: keys become commands, and a live line shows the effect
keyboard        from key presses to a velocity, for terminals, which know no key-up. Pure
screen          parts that full screens of a terminal share
gamepad_drive   joins a gamepad to a robot: its stick drives while the deadman button is held
evdev           gamepads of this Linux machine: which are there, and the events that they send
gamepad         a gamepad: its buttons, its speeds, and the twist that it asks for. Pure
==============  ===================================================================================
"""
