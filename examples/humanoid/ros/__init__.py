"""What messages have to do with it."""
