"""Reads CMakeLists.txt as far as it tells which interfaces a package has; CMake itself is never run."""
