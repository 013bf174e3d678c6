"""FBD and LD networks: to structured text and back."""
