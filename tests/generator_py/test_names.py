"""Names in generated Python."""

from __future__ import annotations

import pytest
from ifgen.definition.interfaces import Field
from ifgen.definition.names import attribute_name, default_name
from ifgen.definition.types import BasicType, NamespacedType
from ifgen.generator_py import names


@pytest.mark.parametrize(
    ("interface", "module"),
    [
        ("Imu", "_imu"),
        ("PointCloud2", "_point_cloud2"),
        ("GPSFix", "_gps_fix"),
        ("UInt8MultiArray", "_u_int8_multi_array"),
        ("TFMessage", "_tf_message"),
        ("MultiDOFJointState", "_multi_dof_joint_state"),
        ("Foo_Request", "_foo__request"),
        ("A", "_a"),
    ],
)
def test_modules_are_called_as_rosidl_calls_them(interface: str, module: str) -> None:
    assert names.module_name(interface) == module
    convert = pytest.importorskip("rosidl_pycommon").convert_camel_case_to_lower_case_underscore
    assert "_" + convert(interface) == module


@pytest.mark.parametrize(
    ("folder", "name", "interface"),
    [
        ("msg", "Foo_Request", "Foo_Request"),
        ("srv", "Foo_Request", "Foo"),
        ("srv", "Foo_Goal_Response", "Foo_Goal"),
        ("action", "Foo_SendGoal_Request", "Foo"),
        ("action", "Foo_GetResult", "Foo"),
        ("action", "Foo_Goal", "Foo"),
        ("action", "Foo_FeedbackMessage", "Foo"),
    ],
)
def test_parts_belong_to_their_interface(folder: str, name: str, interface: str) -> None:
    assert names.interface_name(NamespacedType("p", folder, name)) == interface


def test_classes_of_other_modules_have_their_package_in_their_name() -> None:
    home = NamespacedType("p", "srv", "Foo_Event")
    assert names.class_reference(NamespacedType("p", "srv", "Foo_Request"), home) == "Foo_Request"
    assert names.class_reference(NamespacedType("p", "msg", "Foo"), home) == "p_msg_Foo"
    assert names.class_reference(NamespacedType("q", "srv", "Foo_Request"), home) == "q_srv_Foo_Request"


@pytest.mark.parametrize(
    ("field", "attribute", "slot", "default"),
    [
        ("x", "x", "_x", "X__DEFAULT"),
        ("from", "from_", "_from_", "FROM__DEFAULT"),
        ("check_fields", "check_fields_", "_check_fields_", "CHECK_FIELDS__DEFAULT"),
        ("type", "type", "_type", "TYPE__DEFAULT"),
    ],
)
def test_fields(field: str, attribute: str, slot: str, default: str) -> None:
    of = Field(field, BasicType("int32"))
    assert (attribute_name(of), names.slot_name(of), default_name(of)) == (attribute, slot, default)
