import pytest
from tests.tooth.use.pairs import SPUR


@pytest.fixture(autouse=True)
def own_cache(tmp_path, monkeypatch):
    """No test reads or fills the user's cache."""
    folder = tmp_path / "cache"
    monkeypatch.setenv("LOADSHARE_CACHE", str(folder))
    return folder


@pytest.fixture
def spur(tmp_path):
    """A small spur pair that slices solve in a moment."""
    file = tmp_path / "spur.toml"
    file.write_text(SPUR, encoding="utf-8")
    return file
