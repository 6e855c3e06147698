"""Kinematics and dynamics: where the limbs are, where they can be, and the torques that move them."""
