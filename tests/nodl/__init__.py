"""Tests of NoDL: reading, checking and describing nodes."""
