# SPDX-License-Identifier: BSD-3-Clause
"""The stages as functions, against brute force or known shapes."""
import copy
import pickle

import agrisee
import numpy as np
import pytest
from clouds import sphere


@pytest.fixture(params=[np.float32, np.float64])
def cloud(request):
    return np.random.default_rng(1).uniform(0, 0.1, (400, 3)).astype(request.param)


def distances(points):
    return np.linalg.norm(points[:, None].astype(float) - points[None].astype(float), axis=2)


def test_count_neighbors(cloud):
    assert np.array_equal(agrisee.count_neighbors(cloud, 0.02), (distances(cloud) <= 0.02).sum(1))
    assert np.array_equal(agrisee.count_neighbors(cloud[::-2], 0.02), (distances(cloud[::-2]) <= 0.02).sum(1))


def test_remove_statistical_outliers(cloud):
    near = np.sort(distances(cloud), 1)[:, 1:11].mean(1)
    kept = agrisee.remove_statistical_outliers(cloud, mean_k=10, std_ratio=1.0)
    assert kept.dtype == np.int32 and np.array_equal(kept, np.nonzero(near <= near.mean() + near.std())[0])


def test_dbscan():
    points = np.concatenate([sphere((0, 0, 0), 0.01), sphere((0.1, 0, 0), 0.01), [[0.05, 0, 0]]])
    labels = agrisee.dbscan(points, eps=0.003, min_points=5)
    half = (len(points) - 1) // 2
    assert set(labels[:half]) == {1} and set(labels[half:-1]) == {2} and labels[-1] == 0


def test_normals_and_regions(cloud):
    points = np.concatenate([sphere((x, 0.5, 0.2), 0.035) for x in (-0.045, 0.045)]).astype(cloud.dtype)
    center = np.where(points[:, :1] < 0, (-0.045, 0.5, 0.2), (0.045, 0.5, 0.2))
    true = (points - center) / 0.035
    normals, curvatures = agrisee.estimate_normals(points, viewpoint=(0, 0, 0.2), curvatures=True, radius=0.006)
    assert normals.dtype == cloud.dtype and curvatures.shape == (len(points),)
    front = true[:, 1] < -0.3
    assert np.quantile((normals * true).sum(1)[front], 0.05) > 0.98
    consistent = agrisee.estimate_normals(points)
    for side in (points[:, 0] < 0, points[:, 0] > 0):  # neighbors agree
        assert abs(np.sign((consistent * true).sum(1))[side].mean()) > 0.95
    labels = agrisee.grow_regions(points, true, min_size=100)
    assert labels.max() == 2
    for fruit in (1, 2):
        assert abs(np.sign(points[labels == fruit, 0]).mean()) == 1
    gated = agrisee.grow_regions(points, normals, curvatures, max_curvature=0.05, min_size=100, neighbors=30)
    assert gated.max() >= 1
    with pytest.raises(agrisee.InputError):
        agrisee.grow_regions(points, normals, max_curvature=0.05)
    fit = agrisee.fit_ellipsoid(points[labels == 1], true[labels == 1])
    assert np.allclose(fit.radii, 0.035, atol=5e-4) and "EllipsoidFit" in repr(fit)
    assert agrisee.fit_ellipsoid(points[:3], normals[:3]) is None


@pytest.mark.parametrize("length", [1e-6, 0.5, 10, 1e9])
def test_normals_may_have_any_length(cloud, length):
    points = sphere((0, 0.5, 0.2), 0.035).astype(cloud.dtype)
    normals = ((points - np.array((0, 0.5, 0.2), cloud.dtype)) / 0.035).astype(cloud.dtype)
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    longer = length * normals
    fits = [agrisee.fit_ellipsoid(points, n) for n in (normals, longer)]
    assert np.allclose(fits[1].radii, fits[0].radii, atol=1e-6) and fits[1].inliers == fits[0].inliers
    shifted = points + np.array((0.001, -0.002, 0.001), cloud.dtype)
    moves = [agrisee.icp(points, shifted, n, n) for n in (normals, longer)]
    assert moves[1].rms_before == pytest.approx(moves[0].rms_before, rel=1e-3) and moves[1].matches == moves[0].matches
    assert np.array_equal(*(agrisee.grow_regions(points, n, min_size=100) for n in (normals, longer)))
    results = [agrisee.process(points, n) for n in (normals, longer)]
    assert np.allclose(results[1].normals, results[0].normals, atol=1e-6)


def test_normals_without_direction_are_unknown():
    points = sphere((0, 0.5, 0.2), 0.035)
    normals = (points - (0, 0.5, 0.2)) / 0.035
    unknown = [normals.copy() for _ in range(4)]
    for array, value in zip(unknown, (0, np.nan, np.inf, 1e-300)):
        array[::7] = value
    for call in (lambda n: agrisee.grow_regions(points, n, min_size=100).tolist(), lambda n: agrisee.fit_ellipsoid(points, n).radii.tolist(),
                 lambda n: agrisee.icp(points, points + 0.001, n, n).rms_before, lambda n: agrisee.process(points, n).normals.tolist()):
        answers = [call(n) for n in unknown]
        assert all(answer == answers[0] for answer in answers[1:])


def test_icp():
    target = sphere((0, 0.5, 0.2), 0.035)
    target = target * (1.0, 1.3, 0.7)
    normals = agrisee.estimate_normals(target, viewpoint=(0, 0, 0.2), radius=0.006)
    shift = np.array([0.001, -0.0015, 0.0005])
    found = agrisee.icp(target - shift, target, target_normals=normals)
    assert found.accepted and np.allclose(found.target_T_source[:3, 3], shift, atol=2e-4)
    assert found.rms_after < 0.1 * found.rms_before and "accepted" in repr(found)
    assert found.worse == 0.0
    start = np.eye(4)
    start[:3, 3] = shift
    again = agrisee.icp((target - shift).astype(np.float32), target, target_normals=normals, initial=start)
    assert np.allclose(again.target_T_source, start, atol=1e-4)
    with pytest.raises(agrisee.InputError, match="ICP needs one normal a target point: give target_normals, or set point_to_point"):
        agrisee.icp(target, target)
    with pytest.raises(agrisee.InputError, match="target_normals must have as many rows"):
        agrisee.icp(target, target, target_normals=normals[1:])


def test_results_are_pickled_and_copied():
    points = sphere((0, 0.5, 0.2), 0.035)
    normals = (points - (0, 0.5, 0.2)) / 0.035
    found, fit = agrisee.icp(points, points + 0.001, normals, normals), agrisee.fit_ellipsoid(points, normals)
    for value in (found, fit):
        for twin in (pickle.loads(pickle.dumps(value)), copy.copy(value), copy.deepcopy(value)):
            assert twin.__getstate__() == value.__getstate__() and repr(twin) == repr(value)
    twin = pickle.loads(pickle.dumps(found))
    assert np.array_equal(twin.target_T_source, found.target_T_source) and twin.rms_before == found.rms_before > 0
    twin = pickle.loads(pickle.dumps(fit))
    assert np.array_equal(twin.axes, fit.axes) and np.array_equal(twin.center_covariance, fit.center_covariance)
    with pytest.raises(agrisee.InputError, match="a pickled object"):
        agrisee.IcpResult.__new__(agrisee.IcpResult).__setstate__(fit.__getstate__())


def test_rays():
    vertices = np.array([[0, 0, 1], [1, 0, 1], [0, 1, 1], [0, 0, 2], [1, 0, 2], [0, 1, 2]], float)
    bvh = agrisee.Bvh(vertices, [[3, 4, 5], [0, 1, 2]])
    t, triangle = bvh.rays([[0.2, 0.2, 0.0], [0.2, 0.2, 1.5], [0.9, 0.9, 0.0]], [[0, 0, 1.0], [0, 0, 2.0], [0, 0, 1.0]])
    assert np.allclose(t[:2], [1, 0.25]) and np.isinf(t[2]) and triangle.tolist() == [1, 0, -1]
    distance, triangle, on = bvh.nearest(np.array([[0.2, 0.2, 1.2]], np.float32))
    assert np.allclose(distance, 0.2) and triangle.tolist() == [1] and np.allclose(on, [[0.2, 0.2, 1]])
    assert len(bvh) == 2 and "2 triangles" in repr(bvh)
    assert bvh.rays([[0, 0, 0]], [[0, 0, 1]])[0] == 1  # lists of whole numbers
    for wrong, error in (([[0, 1, 6]], agrisee.InputError), ([[0, 1, -1]], agrisee.InputError), ([[0.0, 1, 2]], TypeError), ([0, 1, 2], agrisee.InputError)):
        with pytest.raises(error):
            agrisee.Bvh(vertices, wrong)


def test_triangles():
    vertices = np.array([[0, 0, 1], [1, 0, 1], [0, 1, 1], [np.nan, 0, 0], [0, 1e300, 0]])
    for none in ([], np.zeros((0, 3), int)):
        assert len(agrisee.Bvh([], none)) == len(agrisee.Bvh(vertices, none)) == 0
    assert len(agrisee.Bvh(vertices, np.array([[0, 1, 2]], np.uint64))) == 1  # the others are not used
    for wrong in (3, 4):
        with pytest.raises(agrisee.InputError, match=f"triangle 1 names vertex {wrong}, which is not finite"):
            agrisee.Bvh(vertices, [[0, 1, 2], [0, 1, wrong]])
    with pytest.raises(agrisee.InputError, match="triangles are out of range, got 18446744073709551615"):
        agrisee.Bvh(vertices, np.full((1, 3), 2**64 - 1, np.uint64))


@pytest.mark.parametrize("call, error, words", [
    (lambda p: agrisee.dbscan(p, eps=-1), agrisee.ParameterError, "eps must be positive"),
    (lambda p: agrisee.dbscan(p, min_point=1), agrisee.ParameterError, "unknown key 'min_point'; did you mean 'min_points'?"),
    (lambda p: agrisee.remove_statistical_outliers(p, mean_k=0), agrisee.ParameterError, "mean_k must be at least 1"),
    (lambda p: agrisee.count_neighbors(p, -1), agrisee.ParameterError, "radius must be not negative"),
    (lambda p: agrisee.count_neighbors(p[:, 0], 1), agrisee.InputError, "points must have the shape (N, 3)"),
    (lambda p: agrisee.fit_ellipsoid(p, None), TypeError, "normals must be an N x 3 array, got NoneType"),
    (lambda p: agrisee.grow_regions(p, p[1:]), agrisee.InputError, "normals must have as many rows"),
])
def test_bad_arguments(cloud, call, error, words):
    with pytest.raises(error) as caught:
        call(cloud)
    assert words in str(caught.value)


def test_threads_and_empty_clouds(cloud):
    for call in (lambda p, t: agrisee.dbscan(p, t, eps=0.01, min_points=3), lambda p, t: agrisee.estimate_normals(p, threads=t, radius=0.02),
                 lambda p, t: agrisee.remove_statistical_outliers(p, t), lambda p, t: agrisee.count_neighbors(p, 0.02, t)):
        assert np.array_equal(call(cloud, 1), call(cloud, 3))
        assert len(call(cloud[:0], 1)) == 0
