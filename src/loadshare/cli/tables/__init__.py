"""Tables of results, as an engineer reads them."""
