"""What a NoDL document says, be it YAML or JSON, before it means anything."""
