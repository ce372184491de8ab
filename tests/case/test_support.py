from loadshare.train import build_train


def test_a_matrix_may_differ_from_a_symmetric_one_in_its_last_digits(drive):
    """Both entries off the diagonal count alike: which is the larger one is no matter."""

    def built(xy: str, yx: str):
        matrix = [["1e8 N/m", xy], [yx, "2e8 N/m"]]
        return build_train(drive.replace({"gears.a.support": matrix})).gears["a"]

    one, other = (
        built("33333333.3 N/m", "33333333.4 N/m"),
        built("33333333.4 N/m", "33333333.3 N/m"),
    )
    assert one.support.tolist() == other.support.tolist()
    assert one.frame.tolist() == other.frame.tolist()
    assert (one.support > 0.0).all()
