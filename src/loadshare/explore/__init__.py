"""A live page of one case: its inputs as sliders, the certified answer next to them."""
