"""Which Vega-Lite draws the pictures."""


def vega_lite_version() -> str:
    """Version of Vega-Lite, such as "6.4", in which Altair writes its charts."""
    import altair as alt

    return ".".join(str(alt.SCHEMA_VERSION).removeprefix("v").split(".")[:2])
