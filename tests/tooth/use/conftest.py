from functools import wraps

import pytest
from tests.tooth.use.pairs import SPUR

from loadshare.tooth.pair import sensitivity

_known: dict[tuple[str, str], object] = {}


@pytest.fixture(autouse=True)
def known_effects(monkeypatch):
    """Find the effect of rims and sampling on each pair only once for all tests. `test_sureness`
    asks for it without a law, and computes it again.
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
    """Keep tests from reading or filling the user's cache."""
    folder = tmp_path / "cache"
    monkeypatch.setenv("LOADSHARE_CACHE", str(folder))
    return folder


@pytest.fixture(scope="module")
def laws(tmp_path_factory):
    return tmp_path_factory.mktemp("laws")


@pytest.fixture
def shared_cache(own_cache, laws, monkeypatch):
    """Use the laws that other tests of the module have computed."""
    monkeypatch.setenv("LOADSHARE_CACHE", str(laws))


@pytest.fixture
def empty_cache(shared_cache, own_cache, monkeypatch):
    """Use an empty cache, even in modules whose tests share laws."""
    monkeypatch.setenv("LOADSHARE_CACHE", str(own_cache))
    return own_cache


@pytest.fixture
def spur(tmp_path):
    """Write a small spur pair that slices solve quickly."""
    file = tmp_path / "spur.toml"
    file.write_text(SPUR, encoding="utf-8")
    return file
