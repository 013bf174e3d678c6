"""The rules, the renaming and the outlines of a plant, as a plugin of plcopen_sfc."""
