"""Reads the interface list from CMakeLists.txt. It never runs CMake itself."""
