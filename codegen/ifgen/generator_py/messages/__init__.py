"""Packages of messages, services and actions."""
