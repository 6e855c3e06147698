"""Messages of shape_msgs.

Classes are loaded when they are first used.
"""

from __future__ import annotations

from ifgen_runtime.lazy import lazy_exports

TYPE_CHECKING = False  # typing itself takes longer to import than this package
if TYPE_CHECKING:
    from shape_msgs.msg._mesh import Mesh as Mesh
    from shape_msgs.msg._mesh_triangle import MeshTriangle as MeshTriangle
    from shape_msgs.msg._plane import Plane as Plane
    from shape_msgs.msg._solid_primitive import SolidPrimitive as SolidPrimitive

__all__ = [
    "Mesh",
    "MeshTriangle",
    "Plane",
    "SolidPrimitive",
]

__getattr__, __dir__ = lazy_exports(
    __name__,
    {
        "Mesh": "_mesh",
        "MeshTriangle": "_mesh_triangle",
        "Plane": "_plane",
        "SolidPrimitive": "_solid_primitive",
    },
)
