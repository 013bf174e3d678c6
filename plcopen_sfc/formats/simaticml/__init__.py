"""SimaticML: the XML of TIA Portal Openness, with blocks in GRAPH, LAD, FBD and SCL, data blocks, types and tags."""
