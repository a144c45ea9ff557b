"""What the simulated robot says of itself: the answer to CONFIG (arcos.md 5.1)."""

from pioneer3.arcos.reports import Config
from pioneer3.sim.body import EMPTY, Body
from pioneer3.sim.equipment import Equipment
from pioneer3.sim.firmware.accessories.battery import LOW
from pioneer3.state import Identity
from pioneer3.units import DECIVOLT, MM, MS, degrees

SERIAL_NUMBER = "SIM"
"""By this AriaCoda knows a simulator (arcos.md 13, row 12)."""
MOST = 9999
TOP_ACCELERATION_MM, TOP_TURN_ACCELERATION_DEG = 2000, 300
"""Of one real P3-AT (arcos.md 5.1)."""


def configuration(
    identity: Identity,
    body: Body,
    equipment: Equipment,
    *,
    cycle: float,
    sonar_cycle: float,
    watchdog: float,
) -> Config:
    """Return CONFIG for `body`; SIPs come every `cycle` [s], the `watchdog` bites after that [s].

    One sonar of each array fires every `sonar_cycle` [s].

    The current limits are those in force, so that a host that set them reads them back. Fields that
    mean nothing to a simulator are 0, as from a robot without that equipment.
    """
    model, linear, angular = body.model, body.drive.linear, body.drive.angular
    return Config(
        family=identity.family,
        model=identity.model,
        serial_number=SERIAL_NUMBER,
        four_motors=int(model.drive == "skid"),
        rotation_top_deg_s=_whole(degrees(model.max_turn_rate)),
        speed_top_mm_s=_whole(model.max_speed / MM),
        rotation_accel_top_deg_s2=TOP_TURN_ACCELERATION_DEG,
        accel_top_mm_s2=TOP_ACCELERATION_MM,
        pwm_max_raw=500,
        name=identity.name,
        sip_cycle_ms=_whole(cycle / MS),
        host_baud_code=0,
        aux1_baud_code=0,
        has_gripper=int(equipment.gripper),
        has_front_sonar=int(bool(model.sonars)),
        has_rear_sonar=int(len(model.sonars) > 8),
        low_battery_decivolts=_whole(LOW / DECIVOLT),
        rev_count_ticks=0,
        watchdog_ms=_whole(watchdog / MS),
        normal_motor_packets=0,
        stall_pwm=0,
        stall_count_ms=0,
        joystick_speed_mm_s=0,
        joystick_rotation_deg_s=0,
        rotation_max_deg_s=_whole(degrees(angular.top)),
        speed_max_mm_s=_whole(linear.top / MM),
        rotation_accel_deg_s2=_whole(degrees(angular.acceleration)),
        rotation_decel_deg_s2=_whole(degrees(angular.deceleration)),
        rotation_kp_raw=40,
        rotation_kv_raw=20,
        rotation_ki_raw=0,
        accel_mm_s2=_whole(linear.acceleration / MM),
        decel_mm_s2=_whole(linear.deceleration / MM),
        translation_kp_raw=40,
        translation_kv_raw=30,
        translation_ki_raw=0,
        front_bumpers=model.front_bumpers,
        rear_bumpers=model.rear_bumpers,
        charger=0,
        sonar_cycle_ms=_whole(sonar_cycle / MS),
        autobaud=0,
        gyro_type=equipment.gyro_type,
        drift_factor_8192nds=0,
        aux2_baud_code=0,
        aux3_baud_code=0,
        ticks_per_mm=0,
        shutdown_decivolts=_whole(EMPTY / DECIVOLT),
        firmware_version="S.0",
        gyro_cw_raw=0,
        gyro_ccw_raw=0,
        kinematics_delay_ms=0,
        lateral_speed_top_mm_s=0,
        lateral_accel_top_mm_s2=0,
        lateral_speed_max_mm_s=0,
        lateral_accel_mm_s2=0,
        lateral_decel_mm_s2=0,
        charge_threshold_raw=0,
    )


def _whole(value: float) -> int:
    return min(round(value), MOST)
