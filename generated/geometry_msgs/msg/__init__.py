"""Messages of geometry_msgs.

Classes are loaded when they are first used.
"""

from __future__ import annotations

from ifgen_runtime.lazy import lazy_exports

TYPE_CHECKING = False  # typing itself takes longer to import than this package
if TYPE_CHECKING:
    from geometry_msgs.msg._accel import Accel as Accel
    from geometry_msgs.msg._accel_stamped import AccelStamped as AccelStamped
    from geometry_msgs.msg._accel_with_covariance import AccelWithCovariance as AccelWithCovariance
    from geometry_msgs.msg._accel_with_covariance_stamped import (
        AccelWithCovarianceStamped as AccelWithCovarianceStamped,
    )
    from geometry_msgs.msg._inertia import Inertia as Inertia
    from geometry_msgs.msg._inertia_stamped import InertiaStamped as InertiaStamped
    from geometry_msgs.msg._point import Point as Point
    from geometry_msgs.msg._point32 import Point32 as Point32
    from geometry_msgs.msg._point_stamped import PointStamped as PointStamped
    from geometry_msgs.msg._polygon import Polygon as Polygon
    from geometry_msgs.msg._polygon_instance import PolygonInstance as PolygonInstance
    from geometry_msgs.msg._polygon_instance_stamped import PolygonInstanceStamped as PolygonInstanceStamped
    from geometry_msgs.msg._polygon_stamped import PolygonStamped as PolygonStamped
    from geometry_msgs.msg._pose import Pose as Pose
    from geometry_msgs.msg._pose2_d import Pose2D as Pose2D
    from geometry_msgs.msg._pose_array import PoseArray as PoseArray
    from geometry_msgs.msg._pose_stamped import PoseStamped as PoseStamped
    from geometry_msgs.msg._pose_with_covariance import PoseWithCovariance as PoseWithCovariance
    from geometry_msgs.msg._pose_with_covariance_stamped import (
        PoseWithCovarianceStamped as PoseWithCovarianceStamped,
    )
    from geometry_msgs.msg._quaternion import Quaternion as Quaternion
    from geometry_msgs.msg._quaternion_stamped import QuaternionStamped as QuaternionStamped
    from geometry_msgs.msg._transform import Transform as Transform
    from geometry_msgs.msg._transform_stamped import TransformStamped as TransformStamped
    from geometry_msgs.msg._twist import Twist as Twist
    from geometry_msgs.msg._twist_stamped import TwistStamped as TwistStamped
    from geometry_msgs.msg._twist_with_covariance import TwistWithCovariance as TwistWithCovariance
    from geometry_msgs.msg._twist_with_covariance_stamped import (
        TwistWithCovarianceStamped as TwistWithCovarianceStamped,
    )
    from geometry_msgs.msg._vector3 import Vector3 as Vector3
    from geometry_msgs.msg._vector3_stamped import Vector3Stamped as Vector3Stamped
    from geometry_msgs.msg._velocity_stamped import VelocityStamped as VelocityStamped
    from geometry_msgs.msg._wrench import Wrench as Wrench
    from geometry_msgs.msg._wrench_stamped import WrenchStamped as WrenchStamped

__all__ = [
    "Accel",
    "AccelStamped",
    "AccelWithCovariance",
    "AccelWithCovarianceStamped",
    "Inertia",
    "InertiaStamped",
    "Point",
    "Point32",
    "PointStamped",
    "Polygon",
    "PolygonInstance",
    "PolygonInstanceStamped",
    "PolygonStamped",
    "Pose",
    "Pose2D",
    "PoseArray",
    "PoseStamped",
    "PoseWithCovariance",
    "PoseWithCovarianceStamped",
    "Quaternion",
    "QuaternionStamped",
    "Transform",
    "TransformStamped",
    "Twist",
    "TwistStamped",
    "TwistWithCovariance",
    "TwistWithCovarianceStamped",
    "Vector3",
    "Vector3Stamped",
    "VelocityStamped",
    "Wrench",
    "WrenchStamped",
]

__getattr__, __dir__ = lazy_exports(
    __name__,
    {
        "Accel": "_accel",
        "AccelStamped": "_accel_stamped",
        "AccelWithCovariance": "_accel_with_covariance",
        "AccelWithCovarianceStamped": "_accel_with_covariance_stamped",
        "Inertia": "_inertia",
        "InertiaStamped": "_inertia_stamped",
        "Point": "_point",
        "Point32": "_point32",
        "PointStamped": "_point_stamped",
        "Polygon": "_polygon",
        "PolygonInstance": "_polygon_instance",
        "PolygonInstanceStamped": "_polygon_instance_stamped",
        "PolygonStamped": "_polygon_stamped",
        "Pose": "_pose",
        "Pose2D": "_pose2_d",
        "PoseArray": "_pose_array",
        "PoseStamped": "_pose_stamped",
        "PoseWithCovariance": "_pose_with_covariance",
        "PoseWithCovarianceStamped": "_pose_with_covariance_stamped",
        "Quaternion": "_quaternion",
        "QuaternionStamped": "_quaternion_stamped",
        "Transform": "_transform",
        "TransformStamped": "_transform_stamped",
        "Twist": "_twist",
        "TwistStamped": "_twist_stamped",
        "TwistWithCovariance": "_twist_with_covariance",
        "TwistWithCovarianceStamped": "_twist_with_covariance_stamped",
        "Vector3": "_vector3",
        "Vector3Stamped": "_vector3_stamped",
        "VelocityStamped": "_velocity_stamped",
        "Wrench": "_wrench",
        "WrenchStamped": "_wrench_stamped",
    },
)
