"""What charts and programs do: execution profiles, nets, the interpreters and the simulation."""
