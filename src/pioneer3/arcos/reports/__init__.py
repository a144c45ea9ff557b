"""Everything a robot can tell its host (arcos.md 4, 5), each report a frozen dataclass.

Fields hold what is on the wire; their names end in the unit, or in `_raw` where the robot model
decides it. What no field has room for is kept in `extra`.

======================  ========================  ======================  ==================
id                      class                     id                      class
======================  ========================  ======================  ==================
0, 1, 2                 SyncEcho                  0xA0                    ArmStatus
2 with texts            SyncIdentity              0xA1                    ArmInfo
0x10                    IrRing                    0xB0, 0xB8, 0xC8        SerialAux
0x20                    Config                    0xC0                    Compass
0x30 .. 0x34            Sip                       0xD0                    Playlist
0x60                    SimLaser                  0xD3                    FirmwareText
0x61                    SimLaserExtended          0xD6                    SafetyState
0x62                    SimStat                   0xD9                    SafetyWarning
0x63                    SimInfo                   0xE0                    GripperState
0x66                    MapChanged                0xF0                    Io
0x90                    Encoders                  0xF8                    Joystick
0x96                    LaserLog                  0xFA                    BatteryInfo
0x98                    GyroRates                 0xFE, 0xFF              LinkLost
0x9A                    Imu                       any other               UnknownReport
======================  ========================  ======================  ==================
"""

from pioneer3.arcos.reports.accessories import (
    ArmInfo,
    ArmJoint,
    ArmStatus,
    BatteryInfo,
    FirmwareText,
    GripperState,
    LaserLog,
    Playlist,
    SafetyState,
    SafetyWarning,
    SerialAux,
    SmartBattery,
)
from pioneer3.arcos.reports.codec import (
    ALL,
    Report,
    UnknownReport,
    from_payload,
    numbers,
    to_payload,
)
from pioneer3.arcos.reports.config import Config
from pioneer3.arcos.reports.flags import Fault, GripperSwitch, SimFlag, SipFlag, SipFlag3
from pioneer3.arcos.reports.handshake import LinkLost, SyncEcho, SyncIdentity
from pioneer3.arcos.reports.sensors import (
    Compass,
    Encoders,
    GyroRates,
    GyroSample,
    Imu,
    Io,
    IrRing,
    Joystick,
)
from pioneer3.arcos.reports.simulator import (
    LaserReading,
    MapChanged,
    SimDevice,
    SimInfo,
    SimLaser,
    SimLaserExtended,
    SimStat,
)
from pioneer3.arcos.reports.sip import (
    NO_TEMPERATURE,
    SIP_MOVING,
    SIP_STOPPED,
    Sip,
    SonarReading,
)

__all__ = [
    "ALL",
    "NO_TEMPERATURE",
    "SIP_MOVING",
    "SIP_STOPPED",
    "ArmInfo",
    "ArmJoint",
    "ArmStatus",
    "BatteryInfo",
    "Compass",
    "Config",
    "Encoders",
    "Fault",
    "FirmwareText",
    "GripperState",
    "GripperSwitch",
    "GyroRates",
    "GyroSample",
    "Imu",
    "Io",
    "IrRing",
    "Joystick",
    "LaserLog",
    "LaserReading",
    "LinkLost",
    "MapChanged",
    "Playlist",
    "Report",
    "SafetyState",
    "SafetyWarning",
    "SerialAux",
    "SimDevice",
    "SimFlag",
    "SimInfo",
    "SimLaser",
    "SimLaserExtended",
    "SimStat",
    "Sip",
    "SipFlag",
    "SipFlag3",
    "SmartBattery",
    "SonarReading",
    "SyncEcho",
    "SyncIdentity",
    "UnknownReport",
    "from_payload",
    "numbers",
    "to_payload",
]
