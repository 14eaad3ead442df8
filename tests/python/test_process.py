# SPDX-License-Identifier: BSD-3-Clause
"""process: arrays in, results out."""
import copy
import gc
import pickle
import threading
import time

import agrisee
import numpy as np
import pytest
from clouds import two_fruit

VIEWPOINT = (0, 0, 0.2)


def values(result):
    """Everything of a result but its times."""
    return pickle.dumps(result.to_dicts()), result.points.tobytes(), result.labels.tobytes(), result.normals.tobytes()


@pytest.fixture(scope="module")
def points():
    return two_fruit().astype(np.float32)


@pytest.fixture(scope="module")
def result(points):
    return agrisee.process(points, viewpoint=VIEWPOINT)


def test_finds_both_fruit(result):
    assert len(result.fruits) == 2
    for fruit in result.fruits:
        assert np.allclose(np.abs(fruit.position), (0.035, 0.5, 0.2), atol=1e-4)
        assert np.allclose(fruit.body.radii, 0.035, atol=1e-4)
        assert fruit.pose.shape == (4, 4) and np.allclose(fruit.pose[:3, 3], fruit.position)
        assert np.allclose(fruit.pose[:3, :3] @ fruit.pose[:3, :3].T, np.eye(3), atol=1e-9)
        assert fruit.points == np.count_nonzero(result.labels == fruit.id)
        assert "35.0 mm" in repr(fruit)
    assert repr(result).startswith("<ScanResult: 2 fruit, ")
    assert result.seconds["total"] > 0 and result.bodies["taken"] == 2 and result.stop_reason == "not_stopped"


def layouts(points):
    n = len(points)
    yield "float64", points.astype(np.float64)
    yield "columns", np.asfortranarray(points)
    yield "a transposed 3 x N", np.ascontiguousarray(points.T).T
    wide = np.zeros((2 * n, 5), np.float32)
    wide[::2, 1:4] = points
    yield "every other row of a wider array", wide[::2, 1:4]
    yield "backwards", np.ascontiguousarray(points[::-1, ::-1])[::-1, ::-1]
    record = np.zeros(n, [("flag", np.uint8), ("xyz", np.float32, 3)])  # packed: not aligned
    record["xyz"] = points
    yield "a field of packed records", record["xyz"]
    yield "every column the same number", np.broadcast_to(points[:1], (1, 3))
    yield "lists", points.astype(float).tolist()


def test_every_layout_gives_the_same(points, result):
    for name, array in layouts(points):
        got = agrisee.process(array, viewpoint=VIEWPOINT)
        if name == "every column the same number":
            assert got.fruits == [] and got.why_no_fruit
        else:
            assert values(got) == values(result), name


def test_threads_do_not_matter(points, result):
    for threads in (1, 2, 3):
        assert values(agrisee.process(points, viewpoint=VIEWPOINT, threads=threads)) == values(result)


def test_normals_that_are_given_are_kept(points, result):
    center = np.where(points[:, :1] < 0, (-0.035, 0.5, 0.2), (0.035, 0.5, 0.2))
    normals = ((points - center) / 0.035).astype(np.float64)
    got = agrisee.process(points, normals)
    assert len(got.fruits) == 2
    kept = {tuple(p): n for p, n in zip(points.tolist(), normals)}
    assert all(np.allclose(n, kept[tuple(p)], atol=1e-6) for p, n in zip(got.points.tolist(), got.normals))
    turned = agrisee.process(points, -normals, viewpoint=VIEWPOINT, check_normals=True)
    assert len(turned.fruits) == 2


def test_views_and_sensors(points):
    back = points * (1, -1, 1) + np.float32((0, 1, 0))  # the same fruit from behind
    both = np.vstack([points, back, [[np.nan] * 3]]).astype(np.float32)
    views = np.repeat([0, 1, -1], [len(points), len(back), 1])
    sensors = [(0.0, 0.0, 0.2), (0.0, 1.0, 0.2)]
    result = agrisee.process(both, views=views, sensors=sensors)
    assert len(result.fruits) == 2 and min(fruit.body.completeness for fruit in result.fruits) > 0.7
    assert set(result.point_views) == {0, 1}
    away = result.normals[:, 1] * np.where(result.point_views == 0, 1, -1) > 0.5
    assert away.mean() < 0.01
    twin = agrisee.process(both.astype(float), views=views.astype(np.int16), sensors=np.array(sensors, np.float32))
    assert len(twin.fruits) == 2
    assert agrisee.process([], views=[], sensors=sensors).fruits == []
    for wrong, error in ((dict(views=views), agrisee.InputError), (dict(views=views[1:], sensors=sensors), agrisee.InputError),
                         (dict(views=views + 1, sensors=sensors), agrisee.InputError),
                         (dict(views=views.astype(float), sensors=sensors), TypeError),
                         (dict(views=np.full(len(both), 2**64 - 1, np.uint64), sensors=sensors), agrisee.InputError),
                         (dict(views=views.astype(str), sensors=sensors), TypeError),
                         (dict(views=views, sensors=[0.0, 0.0, 0.0]), agrisee.InputError),
                         (dict(views=views, sensors=sensors, viewpoint=VIEWPOINT), agrisee.InputError)):
        with pytest.raises(error):
            agrisee.process(both, **wrong)


def test_rows_that_are_not_finite_are_dropped(points, result):
    more = np.vstack([points[:5], np.full((3, 3), np.nan), points[5:]]).astype(np.float32)
    assert values(agrisee.process(more, viewpoint=VIEWPOINT)) == values(result)


def test_a_cloud_without_finite_rows_is_told():
    result = agrisee.process(np.full((5, 3), np.nan))
    assert result.why_no_fruit == "there are no points: no view was taken, or the cloud has none that are finite"
    assert result.warnings == ["all 5 points were dropped: they are not finite"]
    assert agrisee.process([]).warnings == []


def test_a_wrong_viewpoint_is_refused_with_the_arguments_that_help(points):
    behind = dict(viewpoint=(0, 1, 0.2))
    with pytest.raises(agrisee.InputError, match="as seen from the viewpoint.*give views and sensors; if viewpoint is right, add trust_viewpoint=True"):
        agrisee.process(points, **behind)
    assert any("as seen from the viewpoint" in warning for warning in agrisee.process(points, trust_viewpoint=True, **behind).warnings)
    center = np.where(points[:, :1] < 0, (-0.035, 0.5, 0.2), (0.035, 0.5, 0.2))
    inwards = ((center - points) / 0.035).astype(np.float32)
    with pytest.raises(agrisee.InputError, match="if your normals face away from it, add check_normals=True"):
        agrisee.process(points, inwards, viewpoint=VIEWPOINT)


def test_arrays_are_views_that_keep_the_result_alive(points):
    result = agrisee.process(points, viewpoint=VIEWPOINT)
    seen, labels = result.points, result.labels
    assert seen.dtype == np.float32 and seen.shape == (len(labels), 3) and labels.dtype == np.int32
    assert np.shares_memory(seen, result.points) and not seen.flags.writeable and not seen.flags.owndata
    before = seen.copy(), labels.copy()
    del result
    gc.collect()
    np.empty((len(seen), 3), np.float32).fill(7)  # would be put where freed memory was
    assert np.array_equal(seen, before[0]) and np.array_equal(labels, before[1])
    with pytest.raises(ValueError):
        seen[0] = 0


def test_tables_and_dicts(result):
    rows = result.to_dicts()
    assert [row["id"] for row in rows] == [1, 2]
    assert all(not isinstance(v, (list, dict)) for row in rows for v in row.values())
    assert rows[0]["radii_a"] == pytest.approx(0.035, abs=1e-4) and "orientation_world_w" in rows[0]
    fruit = result.fruits[0].to_dict()
    assert fruit["center_world"] == result.fruits[0].body.center.tolist()
    pandas = pytest.importorskip("pandas")
    assert pandas.DataFrame(rows)["position_world_x"].abs().round(3).tolist() == [0.035, 0.035]


def test_pickling_gives_everything_back(result):
    data = pickle.dumps(result)
    again = pickle.loads(data)
    assert pickle.dumps(again) == data and values(again) == values(result) and again.warnings == result.warnings
    fruit = pickle.loads(pickle.dumps(result.fruits[0]))
    assert fruit.to_dict() == result.fruits[0].to_dict()
    for value in (result.fruits[0].body, result.trusses[0]):
        state = value.__getstate__()
        for twin in (pickle.loads(pickle.dumps(value)), copy.copy(value), copy.deepcopy(value)):
            assert twin is not value and twin.__getstate__() == state and repr(twin) == repr(value)
    state = result.__getstate__()
    for wrong in (b"", state[:-1], state + b"x", b"agrisee 0.0.1\n" + state[14:], state[:20]):
        with pytest.raises(agrisee.InputError):
            agrisee.ScanResult.__new__(agrisee.ScanResult).__setstate__(wrong)


@pytest.mark.parametrize("make", [list, lambda: np.empty((0, 3)), lambda: np.empty((0, 3), np.float32), lambda: [[0.0, 0.0, 0.0]]])
def test_few_points_have_no_fruit(make):
    result = agrisee.process(make())
    assert result.fruits == [] and result.to_dicts() == [] and len(result.points) == len(result.labels) == len(make())


@pytest.mark.parametrize("arguments, error, words", [
    (dict(points=np.zeros((4, 2))), agrisee.InputError, "points must have the shape (N, 3), got (4, 2)"),
    (dict(points=np.zeros((4, 3), int)), TypeError, "points must be float32 or float64"),
    (dict(points=np.zeros((4, 3), ">f8")), TypeError, "byte order"),
    (dict(points="cloud.ply"), TypeError, "points must be"),
    (dict(points=None), TypeError, "points must be an N x 3 array, got NoneType"),
    (dict(points=[[0.0, 0.0, 0.0]], normals=np.array(None)), TypeError, "normals must be float32 or float64"),
    (dict(points=[[0.0, None, 0.0]]), TypeError, "points must be an N x 3 array, got list"),
    (dict(points=np.zeros((4, 3)), views=[0, 0, 0, 2], sensors=np.zeros((2, 3))), agrisee.InputError,
     "views must be rows of sensors, of which there are 2 (the first is 0), or -1 where unknown, got 2"),
    (dict(points=np.zeros((4, 3)), normals=np.zeros((3, 3))), agrisee.InputError, "got 3 for 4 points"),
    (dict(points=np.zeros((4, 3)), viewpoint=(0, 0)), agrisee.InputError, "viewpoint must be 3 numbers"),
    (dict(points=np.zeros((4, 3)), viewpoint=(0, 0, np.nan)), agrisee.InputError, "viewpoint must be finite"),
    (dict(points=np.zeros((4, 3)), viewpoint=("0", "0", "0")), TypeError, "viewpoint must be 3 numbers, got ('0', '0', '0')"),
    (dict(points=np.zeros((4, 3)), radius=0.03), agrisee.InputError, "radius must be 2 numbers"),
    (dict(points=np.zeros((4, 3)), radius=(0.06, 0.03)), agrisee.ParameterError, "split.bodies.radius_m"),
    (dict(points=np.zeros((4, 3)), threads=-1), agrisee.ParameterError, "threads must be zero or more"),
    (dict(points=np.zeros((4, 3)), parameters=3), TypeError, "parameters must be"),
    (dict(points=1e3 * two_fruit()), agrisee.InputError, "is it in millimetres?"),
])
def test_bad_input_is_refused(arguments, error, words):
    with pytest.raises(error) as caught:
        agrisee.process(**arguments)
    assert words in str(caught.value)


def test_masked_items_are_refused(points, result):
    masked = np.ma.masked_array(points, mask=points > 0)
    views = np.ma.masked_array(np.zeros(len(points), int), mask=points[:, 0] > 0)
    for name, arguments in (("points", dict(points=masked)), ("normals", dict(points=points, normals=masked)),
                            ("viewpoint", dict(points=points, viewpoint=np.ma.masked_array([0, 0, 0.2], mask=[1, 0, 0]))),
                            ("views", dict(points=points, views=views, sensors=[VIEWPOINT]))):
        with pytest.raises(agrisee.InputError, match=f"^{name} has masked items: fill them"):
            agrisee.process(**arguments)
    with pytest.raises(agrisee.InputError, match="^pose has masked items"):
        agrisee.ReachableView(np.ma.masked_array(np.eye(4), mask=np.eye(4)))
    with pytest.raises(agrisee.InputError, match="^triangles has masked items"):
        agrisee.Bvh(points[:3], np.ma.masked_array([[0, 1, 2]], mask=True))
    assert values(agrisee.process(np.ma.masked_array(points), viewpoint=VIEWPOINT)) == values(result)  # nothing is masked


@pytest.mark.parametrize("arguments", [dict(viewpoint=np.zeros(900)), dict(viewpoint="x" * 900), dict(parameters=np.zeros(900)),
                                       dict(parameters={"gain": np.zeros(900)}), dict(parameters={"gain.min_gain": [0.0] * 900}),
                                       dict(parameters={"max_views": np.zeros(900)})])
def test_messages_do_not_print_long_values(points, arguments):
    with pytest.raises((TypeError, agrisee.InputError)) as caught:
        agrisee.process(points, **arguments)
    assert ", got " in str(caught.value) and len(str(caught.value)) < 150


def test_exceptions_are_pythons():
    assert issubclass(agrisee.FileError, OSError) and issubclass(agrisee.FileError, agrisee.Error)
    assert issubclass(agrisee.ParameterError, ValueError) and issubclass(agrisee.InputError, ValueError)


def test_other_threads_run_meanwhile():
    cloud = two_fruit(200000).astype(np.float32)
    ticks, done = [], threading.Event()

    def tick():
        while not done.is_set():
            ticks.append(time.monotonic())
            time.sleep(0.002)

    thread = threading.Thread(target=tick)
    thread.start()
    begin = time.monotonic()
    agrisee.process(cloud, viewpoint=VIEWPOINT, threads=1)
    end = time.monotonic()
    done.set()
    thread.join()
    assert sum(begin < t < end for t in ticks) > 0.1 * (end - begin) / 0.002
