"""Plays what was recorded, at its pace, and lets others pause, step and seek."""
