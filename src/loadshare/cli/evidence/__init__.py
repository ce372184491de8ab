"""`loadshare chart` and `loadshare stress`: the evidence, measured again."""
