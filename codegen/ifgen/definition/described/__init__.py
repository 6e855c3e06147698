"""Definitions from type descriptions: values and interfaces as plain data, read and checked."""
