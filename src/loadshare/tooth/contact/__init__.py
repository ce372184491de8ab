"""The loaded contact of all lines of action: surfaces, programme, certificate."""
