"""Where its limbs are, where they can be, and what moves them."""
