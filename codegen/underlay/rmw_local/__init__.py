"""The local middleware: endpoints, history, QoS matching and the graph, in one process and plain Python.

It knows nothing of rclpy. What it hands out are `ReadySource`s that an executor waits for.
"""
