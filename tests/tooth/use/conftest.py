from functools import wraps

import pytest
from tests.tooth.use.pairs import SPUR

from loadshare.tooth.pair import sensitivity

_known: dict[tuple[str, str], object] = {}


@pytest.fixture(autouse=True)
def known_effects(monkeypatch):
    """What rims and sampling do to a pair goes with each of its laws: it is found once for all
    tests, of which `test_sureness` asks for it without a law, and finds it anew.
    """
    for name in ("rim_effects", "sampled_deflection"):
        monkeypatch.setattr(sensitivity, name, _found_once(getattr(sensitivity, name)))


def _found_once(find):
    @wraps(find)
    def found(pair):
        key = find.__name__, pair.hash
        if key not in _known:
            _known[key] = find(pair)
        return _known[key]

    return found


@pytest.fixture(autouse=True)
def own_cache(tmp_path, monkeypatch):
    """No test reads or fills the user's cache."""
    folder = tmp_path / "cache"
    monkeypatch.setenv("LOADSHARE_CACHE", str(folder))
    return folder


@pytest.fixture(scope="module")
def laws(tmp_path_factory):
    return tmp_path_factory.mktemp("laws")


@pytest.fixture
def shared_cache(own_cache, laws, monkeypatch):
    """Laws that other tests of the module have computed are known."""
    monkeypatch.setenv("LOADSHARE_CACHE", str(laws))


@pytest.fixture
def empty_cache(shared_cache, own_cache, monkeypatch):
    """No law is known, also where others share theirs."""
    monkeypatch.setenv("LOADSHARE_CACHE", str(own_cache))
    return own_cache


@pytest.fixture
def spur(tmp_path):
    """A small spur pair that slices solve in a moment."""
    file = tmp_path / "spur.toml"
    file.write_text(SPUR, encoding="utf-8")
    return file
