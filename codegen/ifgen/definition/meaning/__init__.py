"""The meaning of fields beyond their types: units, ranges, enumerations, frames, invalid values."""
