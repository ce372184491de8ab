"""No module imports another that imports it in turn, not even inside a function."""

import grimp


def test_no_import_goes_around():
    graph = grimp.build_graph("loadshare", exclude_type_checking_imports=True)
    left = {m: set(graph.find_modules_directly_imported_by(m)) for m in graph.modules}
    while True:
        ends = {m for m, imported in left.items() if not imported}
        if not ends:
            break
        left = {m: imported - ends for m, imported in left.items() if m not in ends}
    assert not left, sorted(left)
