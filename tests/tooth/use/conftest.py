import pytest
from tests.tooth.use.pairs import SPUR


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
