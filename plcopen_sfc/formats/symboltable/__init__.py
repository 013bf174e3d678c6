"""Symbol tables of STEP 7 V5 (``.sdf``).

`sdf_codec`: lines of symbols to tags and back; addresses of STEP 7 V5 with both mnemonics, and those of TIA tags.
"""
