"""Messages of sensor_msgs.

Classes are loaded when they are first used.
"""

from __future__ import annotations

from ifgen_runtime.lazy import lazy_exports

TYPE_CHECKING = False  # typing itself takes longer to import than this package
if TYPE_CHECKING:
    from sensor_msgs.msg._battery_state import BatteryState as BatteryState
    from sensor_msgs.msg._camera_info import CameraInfo as CameraInfo
    from sensor_msgs.msg._channel_float32 import ChannelFloat32 as ChannelFloat32
    from sensor_msgs.msg._compressed_image import CompressedImage as CompressedImage
    from sensor_msgs.msg._fluid_pressure import FluidPressure as FluidPressure
    from sensor_msgs.msg._illuminance import Illuminance as Illuminance
    from sensor_msgs.msg._image import Image as Image
    from sensor_msgs.msg._imu import Imu as Imu
    from sensor_msgs.msg._joint_state import JointState as JointState
    from sensor_msgs.msg._joy import Joy as Joy
    from sensor_msgs.msg._joy_feedback import JoyFeedback as JoyFeedback
    from sensor_msgs.msg._joy_feedback_array import JoyFeedbackArray as JoyFeedbackArray
    from sensor_msgs.msg._laser_echo import LaserEcho as LaserEcho
    from sensor_msgs.msg._laser_scan import LaserScan as LaserScan
    from sensor_msgs.msg._magnetic_field import MagneticField as MagneticField
    from sensor_msgs.msg._multi_dof_joint_state import MultiDOFJointState as MultiDOFJointState
    from sensor_msgs.msg._multi_echo_laser_scan import MultiEchoLaserScan as MultiEchoLaserScan
    from sensor_msgs.msg._nav_sat_fix import NavSatFix as NavSatFix
    from sensor_msgs.msg._nav_sat_status import NavSatStatus as NavSatStatus
    from sensor_msgs.msg._point_cloud import PointCloud as PointCloud
    from sensor_msgs.msg._point_cloud2 import PointCloud2 as PointCloud2
    from sensor_msgs.msg._point_field import PointField as PointField
    from sensor_msgs.msg._range import Range as Range
    from sensor_msgs.msg._region_of_interest import RegionOfInterest as RegionOfInterest
    from sensor_msgs.msg._relative_humidity import RelativeHumidity as RelativeHumidity
    from sensor_msgs.msg._temperature import Temperature as Temperature
    from sensor_msgs.msg._time_reference import TimeReference as TimeReference

__all__ = [
    "BatteryState",
    "CameraInfo",
    "ChannelFloat32",
    "CompressedImage",
    "FluidPressure",
    "Illuminance",
    "Image",
    "Imu",
    "JointState",
    "Joy",
    "JoyFeedback",
    "JoyFeedbackArray",
    "LaserEcho",
    "LaserScan",
    "MagneticField",
    "MultiDOFJointState",
    "MultiEchoLaserScan",
    "NavSatFix",
    "NavSatStatus",
    "PointCloud",
    "PointCloud2",
    "PointField",
    "Range",
    "RegionOfInterest",
    "RelativeHumidity",
    "Temperature",
    "TimeReference",
]

__getattr__, __dir__ = lazy_exports(
    __name__,
    {
        "BatteryState": "_battery_state",
        "CameraInfo": "_camera_info",
        "ChannelFloat32": "_channel_float32",
        "CompressedImage": "_compressed_image",
        "FluidPressure": "_fluid_pressure",
        "Illuminance": "_illuminance",
        "Image": "_image",
        "Imu": "_imu",
        "JointState": "_joint_state",
        "Joy": "_joy",
        "JoyFeedback": "_joy_feedback",
        "JoyFeedbackArray": "_joy_feedback_array",
        "LaserEcho": "_laser_echo",
        "LaserScan": "_laser_scan",
        "MagneticField": "_magnetic_field",
        "MultiDOFJointState": "_multi_dof_joint_state",
        "MultiEchoLaserScan": "_multi_echo_laser_scan",
        "NavSatFix": "_nav_sat_fix",
        "NavSatStatus": "_nav_sat_status",
        "PointCloud": "_point_cloud",
        "PointCloud2": "_point_cloud2",
        "PointField": "_point_field",
        "Range": "_range",
        "RegionOfInterest": "_region_of_interest",
        "RelativeHumidity": "_relative_humidity",
        "Temperature": "_temperature",
        "TimeReference": "_time_reference",
    },
)
