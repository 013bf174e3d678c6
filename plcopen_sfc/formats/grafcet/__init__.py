"""GRAFCETs (IEC 60848): a text to write and review them, and the files of an editor.

`grafcet_text_codec`    the text of a project (``grafcet-text``), in the blocks that an edit replaces
`grafcet_text_reader`   the grammar, and the project of a text with the places of its objects
`other_notations`       texts of grafcet2plc and Grafcet_to_Automaton as such texts
`sfc_losses`            what charts of tools do and a GRAFCET has no word for
`condition_notation`    conditions of tools in the notation of IEC 60848
`grafcet_xmi_codec`     ``.grafcet`` files, written: references made of positions
`grafcet_xmi_reader`    references by position, resolved
`grafcet_xmi_terms`     terms of these files, and conditions as text
"""
