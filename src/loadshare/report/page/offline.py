"""Scripts and templates that are written into a page so that it works without a network."""

from __future__ import annotations

import re
from base64 import b64encode
from functools import cache
from hashlib import sha256
from importlib.metadata import version
from typing import TYPE_CHECKING, Any

from loadshare.report import vega_lite
from loadshare.user_cache import digest_of, read_entry, write_entry

if TYPE_CHECKING:
    from jinja2 import Environment


OWN_SCRIPTS = "OWN_SCRIPTS"
"""Placeholder in the policy of a page for the hashes of its scripts."""
SCRIPT = re.compile("<script>(.*?)</script>", re.DOTALL)
EXPOSED = "window.vegaEmbed = vegaEmbed;"
"""The part of the bundle that the page's own script needs."""


@cache
def scripts() -> str:
    """Return the JavaScript that draws Vega-Lite specifications, for a script element.

    Assembling it takes about a second, so it is kept in the user's cache.
    """
    import vl_convert

    parts = (version("vl-convert-python"), vega_lite.version(), EXPOSED)
    key = digest_of("\n".join(parts))
    place = f"scripts/{key}.js"
    found = read_entry(place)
    if found is None:
        bundle = str(vl_convert.javascript_bundle(EXPOSED, vl_version=vega_lite.version()))
        # A closing tag within a text of the bundle would end the element.
        found = bundle.replace("</script", "<\\/script")
        write_entry(place, found)
    return found


@cache
def templates() -> Environment:
    """Return the templates of this package; what they insert is escaped."""
    from jinja2 import Environment, PackageLoader, StrictUndefined

    made = Environment(
        loader=PackageLoader("loadshare.report.page", "templates"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    # JSON has no NaN; a browser would refuse the whole figure.
    made.policies["json.dumps_kwargs"] = {"allow_nan": False, "ensure_ascii": True}
    return made


def render(template: str, **values: Any) -> str:
    """Fill in a template; the policy of the page lets only its own scripts run."""
    page = templates().get_template(template).render(scripts=scripts(), **values)
    hashes = (sha256(script.encode()).digest() for script in SCRIPT.findall(page))
    allowed = " ".join(f"'sha256-{b64encode(found).decode()}'" for found in hashes)
    return page.replace(OWN_SCRIPTS, allowed, 1)
