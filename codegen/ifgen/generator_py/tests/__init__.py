"""Tests for generated packages and nodes."""
