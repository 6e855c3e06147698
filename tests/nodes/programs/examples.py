"""The two example nodes of the format's description: they start, with everything that is included and named."""

import rclpy
from gait_planner.gait_planner import GaitPlannerNode
from rclpy.parameter import Parameter
from stage import Stage, say
from std_srvs.srv import Trigger
from whole_body_controller.whole_body_controller import WholeBodyControllerNode

rclpy.init()
joints = [Parameter("joints", value=["l_hip", "l_knee", "l_ankle"])]
planner, controller = GaitPlannerNode(), WholeBodyControllerNode(parameter_overrides=joints)
stage = Stage(planner, controller)
for node in (planner, controller):
    own = [s.topic_name for s in node.subscriptions if not s.topic_name.endswith("/_action/feedback")]
    say(node.get_name(), sorted(own), sorted(c.srv_name for c in node.clients))
    say("parameters", node.parameters)
say("imu", controller.imu_data_subscription.qos_profile.reliability.name)
say("stop", stage.call(Trigger, "whole_body_controller/stop", Trigger.Request()))
for node in (planner, controller, stage.peer):
    node.destroy_node()
rclpy.shutdown()
