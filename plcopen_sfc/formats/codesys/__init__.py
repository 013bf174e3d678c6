"""CODESYS V3 and TwinCAT 3 PLCopenXML: TC6 2.0 and what these tools add to it."""
