"""What all tests share: the nodes that they start are heard by nobody else on this machine or beyond it."""

import os

from .domains import claim

os.environ["ROS_DOMAIN_ID"] = str(claim())
os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"
