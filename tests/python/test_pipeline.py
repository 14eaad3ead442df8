# SPDX-License-Identifier: BSD-3-Clause
"""Pipeline, Workcell and the simulation."""
import copy
import gc
import json
import os
import pickle
import weakref
from collections import UserDict
from types import MappingProxyType

import agrisee
import numpy as np
import pytest
from test_process import values


@pytest.fixture(scope="module")
def scene(tmp_path_factory):
    return agrisee.make_truss(tmp_path_factory.mktemp("truss"), total=3, hidden=0, seed=2)


@pytest.fixture(scope="module")
def scanned(scene):
    return agrisee.scan(scene, noise="l515", seed=1)


@pytest.fixture
def camera(scene):
    return agrisee.SimulatedCamera(scene, noise="l515", seed=1)


def loop(pipeline, camera, most=99, millimetres=False):
    """The loop of a robot; a view that was taken: (ReachableView, View)."""
    taken = []
    while len(taken) < most and (view := pipeline.next_view()) is not None:
        depth = camera.capture(view.pose)
        if millimetres:
            seen = pipeline.observe(np.round(1000 * depth).astype(np.uint16), view.pose, view.joints, depth_scale=0.001)
        else:
            seen = pipeline.observe(depth, view.pose, view.joints)
        taken.append((view, seen))
    return taken


def test_scan_finds_the_fruit(scanned):
    assert len(scanned.fruits) == 3 and len(scanned.views) > 3
    assert scanned.stop_reason in ("low_gain", "no_reachable_view", "max_views")
    assert scanned.fruits[0].picking.order >= 1 and "views, ended by" in repr(scanned)
    assert all(0 <= fruit.picking.crossed < 0.01 for fruit in scanned.fruits)
    assert 0 < scanned.completeness["seen"] <= 1 and scanned.trusses[0].pose.shape == (4, 4)
    assert pickle.dumps(pickle.loads(pickle.dumps(scanned))) == pickle.dumps(scanned)
    assert len(scanned.raw_points) >= len(scanned.points) == len(scanned.point_views)


def test_write(scene, scanned, tmp_path):
    scanned.write(tmp_path / "result", scene)
    with open(tmp_path / "result" / "fruits.json", encoding="utf-8") as file:
        assert json.load(file) == [fruit.to_dict() for fruit in scanned.fruits]
    assert "<html" in (tmp_path / "result" / "report.html").read_text()[:1000]
    with open(tmp_path / "result" / "run.json", encoding="utf-8") as file:
        assert json.load(file)["version"] == agrisee.__version__
    with pytest.raises(agrisee.FileError, match=r"result: already holds a result \(run.json\); use force=True to overwrite it"):
        agrisee.process([]).write(tmp_path / "result")
    (tmp_path / "result" / "truss.png").write_bytes(b"of an older result")
    agrisee.process([]).write(tmp_path / "result", force=True)
    assert json.loads((tmp_path / "result" / "fruits.json").read_text()) == []
    assert not (tmp_path / "result" / "truss.png").exists()
    agrisee.process([]).write(tmp_path / "empty")
    assert os.path.getsize(tmp_path / "empty" / "report.html") > 1000
    (tmp_path / "file").write_text("")
    with pytest.raises(agrisee.FileError):
        scanned.write(tmp_path / "file")


def test_a_scene_is_not_overwritten(scene, tmp_path):
    made = agrisee.make_truss(tmp_path, total=3, hidden=0, seed=2)
    before = made.read_bytes()
    with pytest.raises(agrisee.FileError, match="already holds a scene; use force=True to overwrite it"):
        agrisee.make_truss(tmp_path, total=3, hidden=0, seed=3)
    assert made.read_bytes() == before == scene.read_bytes()
    assert agrisee.make_truss(tmp_path, total=3, hidden=0, seed=3, force=True).read_bytes() != before


def test_own_loop_gives_the_same_result(scene, scanned, camera):
    pipeline = agrisee.Pipeline(scene, seed=1)
    taken = loop(pipeline, camera)
    result = pipeline.result()
    assert values(result) == values(scanned)
    assert pipeline.next_view() is None and pipeline.stop_reason == scanned.stop_reason
    view, seen = taken[0]
    assert np.array_equal(seen.pose, view.pose) and np.array_equal(seen.joints, view.joints) and seen.points_in > 100
    assert len(pipeline.views) == len(taken) and len(pipeline.points) > 1000 and pipeline.warnings == []
    assert "views" in repr(pipeline) and pipeline.completeness["seen"] > 0.3
    assert pickle.loads(pickle.dumps(seen)).points_in == seen.points_in


def test_millimetres(scene, camera):
    pipeline = agrisee.Pipeline(scene, {"max_views": 3})
    assert len(loop(pipeline, camera, millimetres=True)) == 3
    assert len(pipeline.result().fruits) == 3


def test_the_largest_whole_number_is_no_return(scene, camera):
    first = agrisee.Pipeline(scene).next_view()
    depth = camera.capture(first.pose)
    seen = []
    for code in (0, 65535):  # 65535 units are 1.6 m, within the camera's range
        units = np.where(depth > 0, np.round(depth / 25e-6), code).astype(np.uint16)
        units[::2] = code
        pipeline = agrisee.Pipeline(scene)
        seen.append((pipeline.observe(units, first.pose, depth_scale=25e-6).points_in, pipeline.points.tobytes(), pipeline.next_view().pose.tobytes()))
    assert seen[0] == seen[1] and seen[0][0] > 100


def test_lens_distortion(scene, camera):
    pose = agrisee.Pipeline(scene).next_view().pose
    depth = camera.capture(pose)
    points = []
    for distortion in ([], None, [0.1, 0, 0, 0, 0], (0.1, 0.0, 0.0, 0.0), np.array([[0.1, 0, 0, 0, 0]]), np.array([[0.1], [0], [0], [0], [0]])):
        pipeline = agrisee.Pipeline(scene)
        pipeline.observe(depth, pose, distortion=distortion)
        points.append(pipeline.points.tobytes())
    assert points[0] == points[1] != points[2] and len(set(points[2:])) == 1
    for wrong, error, words in ((np.zeros((2, 2)), agrisee.InputError, "one row or column"), ([0.1], agrisee.InputError, "4, 5 or 8"),
                                ("0.1", TypeError, "must be a list of numbers, got str")):
        with pytest.raises(error, match=f"distortion.*{words}"):
            agrisee.Pipeline(scene).observe(depth, pose, distortion=wrong)


def test_masked_depths_are_no_return(scene, camera):
    pose = agrisee.Pipeline(scene).next_view().pose
    depth = camera.capture(pose)
    assert agrisee.Pipeline(scene).observe(np.ma.masked_array(depth, mask=True), pose).points_in == 0
    half = np.arange(depth.shape[0])[:, None] % 2 * np.ones_like(depth)
    for image, scale in ((depth, 1.0), (np.round(1000 * depth).astype(np.uint16), 0.001)):
        twins = [agrisee.Pipeline(scene), agrisee.Pipeline(scene), agrisee.Pipeline(scene)]
        masked, zeros, plain = (np.ma.masked_array(image, mask=half), (image * half == 0) * image, np.ma.masked_array(image))
        seen = [p.observe(given, pose, depth_scale=scale).points_in for p, given in zip(twins, (masked, zeros, plain))]
        assert twins[0].points.tobytes() == twins[1].points.tobytes() and 100 < seen[0] == seen[1] < seen[2]


def test_candidates_refusals_and_planners(scene):
    pipeline = agrisee.Pipeline(scene, planner="random", seed=3)
    first = pipeline.next_view(joints=pipeline_start(scene))
    pipeline.refused()
    second = pipeline.next_view()
    assert not np.array_equal(first.pose, second.pose)
    with pytest.raises(agrisee.ParameterError, match="planner must be"):
        agrisee.Pipeline(scene, planner="best")


def test_workcells_and_views_are_pickled_and_copied(scene, scanned, camera):
    keep_out = [{"name": "table", "box": {"center": [0, 0, -0.06], "size": [0.8, 0.8, 0.1]}},
                {"name": "post", "cylinder": {"center": [0.5, 0.1, 0.3], "radius": 0.02, "height": 0.6}}]
    big = agrisee.Workcell.from_dict({
        "robot": {"arm": "ur10e", "base": {"xyz": [0.1, 0, 0], "rpy": [0, 0, 0.1]}, "gripper": {"xyz": [0, 0, 0.1], "rpy": [0, 0, 0]}},
        "sensor": {"width": 64, "height": 48, "fx": 50, "fy": 50, "cx": 31.5, "cy": 23.5, "range": [0.2, 3]},
        "scan_volume": {"min": [-0.2, 0.4, 0], "max": [0.2, 0.75, 0.45]}, "keep_out": keep_out})
    asked = []
    assert agrisee.Pipeline(scene, reach=lambda request, joints: asked.append(request)).next_view() is None
    view = agrisee.Pipeline(scene).next_view()
    for value in (big, camera.workcell, scanned.fruits[0].picking, view, asked[0], agrisee.ReachableView(np.eye(4))):
        for twin in (pickle.loads(pickle.dumps(value)), copy.copy(value), copy.deepcopy(value)):
            assert twin.__getstate__() == value.__getstate__() and repr(twin) == repr(value)
    for cell in (big, camera.workcell):
        twin = pickle.loads(pickle.dumps(cell))
        assert twin.arm == cell.arm and np.array_equal(twin.start, cell.start) and twin.intrinsics == cell.intrinsics
        assert np.array_equal(twin.base, cell.base) and np.array_equal(twin.tool, cell.tool)
        views = [agrisee.Pipeline(each).next_view() for each in (cell, twin)]
        assert repr(views[0]) == repr(views[1]) and (views[0] is None or np.array_equal(views[0].joints, views[1].joints))


def pipeline_start(scene):
    return agrisee.Workcell.from_yaml(scene).start


def test_a_reach_in_python(scene, camera):
    asked = []

    def reach(request, joints):
        asked.append((request.target, joints))
        assert np.isclose(np.linalg.norm(request.direction), 1) and request.distance_min <= request.distance
        if request.direction[1] < 0.3:  # from the front only
            return None
        return agrisee.ReachableView(request.pose, request.target, joints=joints + 0.1, move_time=0.5)

    pipeline = agrisee.Pipeline(scene, {"gain": {"candidates": 200}, "max_views": 4}, reach=reach)
    taken = loop(pipeline, camera)
    assert len(taken) == 4 and len(asked) > 200
    assert all(view.pose[1, 2] > 0.29 and view.move_time == 0.5 for view, _ in taken)
    assert len(pipeline.result().fruits) == 3 and pipeline.result().fruits[0].picking.reason == "not_tested"


def test_what_a_reach_raises_is_raised(scene):
    class Broken(Exception):
        pass

    def broken(request, joints):
        raise Broken("no answer")

    pipeline = agrisee.Pipeline(scene, reach=broken)
    with pytest.raises(Broken, match="no answer"):
        pipeline.next_view()
    with pytest.raises(TypeError, match="reach must return agrisee.ReachableView or None, got 3"):
        agrisee.Pipeline(scene, reach=lambda request, joints: 3).next_view()
    with pytest.raises(TypeError, match="reach must be a function"):
        agrisee.Pipeline(scene, reach=3)
    assert agrisee.Pipeline(scene, reach=lambda request, joints: None).next_view() is None


class Robot:
    """Keeps a pipeline that calls one of its methods."""

    def __init__(self, scene, kind=agrisee.Pipeline):
        self.pipeline = kind(scene, reach=self.reach)

    def reach(self, request, joints):
        return None


class OwnPipeline(agrisee.Pipeline):
    def __init__(self, *arguments, **keywords):
        if gc.collect() >= 0:  # the object is not complete
            super().__init__(*arguments, **keywords)


@pytest.mark.parametrize("kind", [agrisee.Pipeline, OwnPipeline])
def test_a_pipeline_that_calls_its_owner_is_collected(scene, kind):
    robot = Robot(scene, kind)
    assert robot.pipeline.next_view() is None
    gone = weakref.ref(robot), weakref.ref(robot.pipeline)
    gc.collect()
    assert gone[0]() is robot and robot.pipeline.next_view() is None  # in use
    del robot
    gc.collect()
    assert [reference() for reference in gone] == [None, None]


def test_progress(scene, scanned):
    told = []
    result = agrisee.scan(scene, noise="l515", seed=1, progress=lambda number, view: told.append((number, view.points_in)))
    assert told == [(i + 1, view.points_in) for i, view in enumerate(result.views)]
    assert values(result) == values(scanned)

    def stop(number, view):
        raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough"):
        agrisee.scan(scene, progress=stop)


def test_a_pipeline_at_work_refuses_other_calls(scene):
    def reach(request, joints):
        pipeline.next_view()

    pipeline = agrisee.Pipeline(scene, reach=reach)
    with pytest.raises(RuntimeError, match="at work already"):
        pipeline.next_view()


def test_a_pipeline_at_work_shows_nothing(scene):
    refused = []

    def reach(request, joints):
        for name in ("views", "warnings", "points", "candidates", "completeness", "stop_reason"):
            with pytest.raises(agrisee.BusyError, match="at work already"):
                getattr(pipeline, name)
            refused.append(name)

    pipeline = agrisee.Pipeline(scene, {"gain.candidates": 10}, reach=reach)
    assert pipeline.next_view() is None and len(set(refused)) == 6 and pipeline.views == []
    assert issubclass(agrisee.BusyError, agrisee.Error) and issubclass(agrisee.BusyError, RuntimeError)


def test_bad_frames_are_refused_and_the_scan_goes_on(scene, camera):
    pipeline = agrisee.Pipeline(scene)
    view = pipeline.next_view()
    depth = camera.capture(view.pose)
    for arguments, error, words in [
        ((depth[:-1], view.pose), agrisee.InputError, "depth must have the shape (768, 1024) of the workcell's camera, got (767, 1024)"),
        ((depth.astype(float), view.pose), TypeError, "depth must be float32 or uint16, got float64"),
        ((depth.tolist(), view.pose), TypeError, "depth must be an array"),
        ((1000 * depth, view.pose), agrisee.InputError, "is it in millimetres"),
        (((1000 * depth).astype(np.uint16), view.pose), agrisee.InputError, "depth_scale is the length of a unit: 0.001 for millimetres"),
        ((depth, view.pose, None, 0.001), agrisee.InputError, "multiplied by the camera's depth unit once more? (depth_scale is"),
        ((depth, view.pose[:3]), agrisee.InputError, "pose must be a 4 x 4 matrix"),
        ((depth, 2 * view.pose), agrisee.InputError, "last row"),
        ((depth, view.pose.T), agrisee.InputError, "last row is 0 0 0 1. Is it transposed?"),
        ((depth, np.nan * view.pose), agrisee.InputError, "pose is not finite"),
        ((depth, np.diag([2.0, 2, 2, 1])), agrisee.InputError, "world_T_optical"),
        ((depth, view.pose, [0, 1]), agrisee.InputError, "joints must be 6 numbers"),
        ((depth, view.pose, ["1"] * 6), TypeError, "joints must be 6 numbers, got ['1', '1', "),
        ((depth, view.pose, [True] * 6), TypeError, "joints must be 6 numbers"),
        ((depth, view.pose.astype(str)), TypeError, "pose must be a 4 x 4 matrix, got "),
        ((depth, view.pose, np.degrees(view.joints)), agrisee.InputError, "are the angles in degrees?"),
        ((depth, view.pose, None, -1.0), agrisee.ParameterError, "depth_scale must be positive"),
    ]:
        with pytest.raises(error) as caught:
            pipeline.observe(*arguments)
        assert words in str(caught.value)
    assert pipeline.views == []
    assert pipeline.observe(depth[::-1][::-1], view.pose, view.joints).points_in > 100
    assert pipeline.observe_points(camera_points(depth, camera), view.pose).points_in > 100
    assert not any("by the joints" in warning for warning in pipeline.warnings)
    pipeline.observe(depth, view.pose, np.zeros(6))
    assert any("by the joints of 1 of 3 views" in warning for warning in pipeline.warnings)


def test_discarded_views_are_told(scene, scanned, camera):
    poses = [view.pose for view in scanned.views]
    pipeline = agrisee.Pipeline(scene)
    for late, pose in zip(poses[:1] + poses, poses):
        pipeline.observe(camera.capture(pose), late)
    result = pipeline.result()
    discarded = sum(view.discarded for view in result.views)
    assert discarded > len(poses) / 4
    assert result.warnings[0].startswith(f"{discarded} of {len(poses)} views were discarded: views ")
    assert "is each pose that of its image" in result.warnings[0] and pipeline.warnings == result.warnings
    for shown in (result, pipeline):
        assert f" {len(poses)} views ({discarded} discarded), " in repr(shown)
    assert scanned.warnings == [] and "discarded" not in repr(scanned)


def camera_points(depth, camera):
    k = camera.workcell.intrinsics
    v, u = np.nonzero(depth)
    z = depth[v, u]
    return np.c_[(u - k["cx"]) / k["fx"] * z, (v - k["cy"]) / k["fy"] * z, z]


def test_workcells(scene, tmp_path):
    cell = agrisee.Workcell.from_yaml(scene)
    assert cell.arm == "ur3" and cell.intrinsics["width"] == 1024 and cell.start.shape == (6,)
    low, high = cell.scan_volume
    twin = agrisee.Workcell.from_dict({
        "robot": {"base": {"xyz": [0, 0, 0], "rpy": [0, 0, 0]}, "start": cell.start},
        "sensor": {"width": 64, "height": 48, "fx": 50, "fy": 50, "cx": 31.5, "cy": 23.5},
        "scan_volume": {"min": low, "max": high}})
    frozen = MappingProxyType({"robot": UserDict(base=MappingProxyType({"xyz": np.zeros(3), "rpy": (0, 0, 0)}), start=cell.start),
                               "sensor": {"width": 64, "height": 48, "fx": 50, "fy": 50, "cx": 31.5, "cy": 23.5},
                               "scan_volume": MappingProxyType({"min": low, "max": high})})
    for other in (agrisee.Workcell.from_dict(frozen), agrisee.Workcell.from_dict(dict(frozen))):
        assert repr(other) == repr(twin) and np.array_equal(other.start, twin.start)
    assert agrisee.Pipeline(frozen).views == []
    assert np.array_equal(twin.scan_volume[0], low) and twin.intrinsics["width"] == 64 and "ur3" in repr(twin)
    assert agrisee.Pipeline(twin).next_view() is not None
    with pytest.raises(agrisee.ParameterError, match="robot.arm.*for another arm, give the pipeline a function `reach`"):
        agrisee.Workcell.from_dict({"robot": {"arm": "ur99", "base": {"xyz": [0, 0, 0], "rpy": [0, 0, 0]}},
                                    "scan_volume": {"min": low, "max": high}})
    with pytest.raises(agrisee.ParameterError, match="scan_volume"):
        agrisee.Workcell.from_dict({"robot": {"base": {"xyz": [0, 0, 0], "rpy": [0, 0, 0]}}})
    with pytest.raises(agrisee.FileError, match="no such file"):
        agrisee.Pipeline(tmp_path / "none.yaml")
    with pytest.raises(TypeError, match="workcell must be"):
        agrisee.Pipeline(3)
    assert os.path.samefile(scene, os.path.join(os.path.dirname(scene), "scene.yaml"))
    for folder in (scene.parent, str(scene.parent)):  # as the command takes it
        assert agrisee.Workcell.from_yaml(folder).name == agrisee.SimulatedCamera(folder).workcell.name == cell.name
        assert agrisee.Pipeline(folder).views == [] and len(agrisee.scan(folder, parameters={"max_views": 1}).views) == 1
    with pytest.raises(agrisee.FileError, match="scene.yaml"):
        agrisee.scan(tmp_path)
