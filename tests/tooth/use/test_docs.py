"""The page on tooth contact names every key and shows the results of the pair files."""

import re

from tests.tooth.use.pairs import PAIRS, written

from loadshare.case.described import schema_of
from loadshare.tooth.pair.file import load_pair
from loadshare.tooth.pair.model import CONTENTS

PAGE = (PAIRS.parents[2] / "docs/ltca.md").read_text(encoding="utf-8")


def keys():
    for model in CONTENTS.values():
        schema = schema_of(model)
        for table in (schema, *schema["$defs"].values()):
            yield from table.get("properties", {})


def test_the_page_names_every_key():
    missing = {key for key in keys() if f"`{key}`" not in PAGE}
    assert not missing


def test_the_pair_file_of_the_page_is_one(tmp_path):
    (text,) = re.findall(r"```toml\n(kind = .*?)```", PAGE, re.DOTALL)
    assert load_pair(written(tmp_path, text)).title == "Pinion and wheel"
