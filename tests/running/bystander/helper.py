"""Another module of the name that programs/ has."""

WHO = "bystander"
