# SPDX-License-Identifier: BSD-3-Clause
"""Functions are Python's: signatures, messages about arguments, pickling."""
import inspect
import multiprocessing
import pickle
import subprocess
import sys
from concurrent.futures import ProcessPoolExecutor

import agrisee
import numpy as np
import pytest
from agrisee import _calls
from clouds import two_fruit


@pytest.fixture(scope="module")
def scene(tmp_path_factory):
    return agrisee.make_truss(tmp_path_factory.mktemp("truss"), total=1, hidden=0, seed=2)


@pytest.mark.parametrize("call, words", [
    (lambda p, s: agrisee.process(p, view_point=(0, 0, 0.2)), "process(): got an unexpected keyword argument 'view_point'; did you mean 'viewpoint'?"),
    (lambda p, s: agrisee.process(p, xyz=1), "process(): got an unexpected keyword argument 'xyz'"),
    (lambda p, s: agrisee.process(), "process(): missing a required argument: 'points'"),
    (lambda p, s: agrisee.process(p, None, None, None, None, 1, True), "process(): too many positional arguments"),
    (lambda p, s: agrisee.process(p, points=p), "process(): multiple values for argument 'points'"),
    (lambda p, s: agrisee.process(p, threads=1.5), "process(): threads must be a whole number, got 1.5"),
    (lambda p, s: agrisee.process(p, threads=None), "process(): threads must be a whole number, got None"),
    (lambda p, s: agrisee.process(p, threads=2**40), "process(): threads is out of range, got 1099511627776"),
    (lambda p, s: agrisee.process(p, trust_viewpoint="no"), "process(): trust_viewpoint must be True or False, got 'no'"),
    (lambda p, s: agrisee.dbscan(p, 0.01), "dbscan(): threads must be a whole number, got 0.01"),
    (lambda p, s: agrisee.count_neighbors(p, p), "count_neighbors(): radius must be a number, got ndarray"),
    (lambda p, s: agrisee.count_neighbors(p, "0.1"), "count_neighbors(): radius must be a number, got '0.1'"),
    (lambda p, s: agrisee.scan(3), "scan(): scene must be a path, got 3"),
    (lambda p, s: agrisee.scan(s, noise=None), "scan(): noise must be a text, got None"),
    (lambda p, s: agrisee.Pipeline(s, seed=-1), "Pipeline(): seed is out of range, got -1"),
    (lambda p, s: agrisee.Pipeline(s, param={}), "Pipeline(): got an unexpected keyword argument 'param'; did you mean 'parameters'?"),
    (lambda p, s: agrisee.Pipeline(s).observe(p, np.eye(4), depth_scale="0.001"), "Pipeline.observe(): depth_scale must be a number, got '0.001'"),
    (lambda p, s: agrisee.Pipeline(s).observe(p, np.eye(4), color=p), "Pipeline.observe(): got an unexpected keyword argument 'color'"),
    (lambda p, s: agrisee.Parameters({"max_views": 3}), "Parameters(): preset must be a text, got dict"),
    (lambda p, s: agrisee.Parameters().expect_radii("a", 1), "Parameters.expect_radii(): smallest must be a number, got 'a'"),
    (lambda p, s: agrisee.Workcell.from_yaml(b=3), "Workcell.from_yaml(): missing a required argument: 'path'"),
])
def test_messages_name_the_argument(scene, call, words):
    with pytest.raises(TypeError) as caught:
        call(two_fruit(), scene)
    assert str(caught.value) == words and caught.value.__context__ is None


def test_types_of_all_versions_of_pybind11_are_known():
    for annotation, known in (("int", "int"), ("typing.SupportsInt", "int"), ("typing.SupportsInt | typing.SupportsIndex", "int"),
                              ("typing.SupportsFloat | typing.SupportsIndex", "float"), ("Union[os.PathLike, str, bytes]", "os.pathlike"),
                              ("os.PathLike | str | bytes", "os.pathlike"), ("bool", "bool"), ("str", "str")):
        assert _calls._type(annotation) == known and known in _calls._TYPES
    assert _calls._type("object") not in _calls._TYPES


def test_a_type_error_of_a_callback_is_kept(scene):
    with pytest.raises(TypeError, match="positional argument"):
        agrisee.Pipeline(scene, reach=lambda: None).next_view()


def test_signatures():
    assert str(inspect.signature(agrisee.count_neighbors)) == "(points, radius, threads=0)"
    assert str(inspect.signature(agrisee.dbscan)) == "(points, threads=0, **kwargs)"
    assert list(inspect.signature(agrisee.Pipeline).parameters)[:2] == ["workcell", "parameters"]
    assert list(inspect.signature(agrisee.Pipeline.next_view).parameters) == ["self", "joints"]
    for name in agrisee.__all__:
        value = getattr(agrisee, name)
        members = vars(value).items() if isinstance(value, type) and not issubclass(value, Exception) else [("", value)]
        for member, function in members:
            if callable(function) and not member.startswith("_") and not isinstance(function, type):
                assert inspect.signature(function) and function.__doc__ and not function.__doc__.startswith(function.__name__ + "("), member


def test_functions_are_pickled_by_name():
    for function in (agrisee.process, agrisee.scan, agrisee.Parameters.from_dict, agrisee.Pipeline.next_view):
        assert pickle.loads(pickle.dumps(function)) is function


@pytest.mark.parametrize("how", ["fork", "spawn"])
def test_other_processes_process_clouds(how):
    clouds = [two_fruit(), two_fruit()[::2], np.zeros((0, 3))]
    here = [len(agrisee.process(cloud, threads=2).fruits) for cloud in clouds]
    with ProcessPoolExecutor(2, mp_context=multiprocessing.get_context(how)) as pool:
        assert [len(result.fruits) for result in pool.map(agrisee.process, clouds)] == here == [2, 2, 0]


def test_help_shows_no_types_of_the_compiler():
    done = subprocess.run([sys.executable, "-B", "-c", "import agrisee; help(agrisee.Pipeline.observe)"], capture_output=True, text=True, check=True)
    assert "observe(self, depth, pose, joints=None, depth_scale=1.0, distortion=None)" in done.stdout
    assert "object" not in done.stdout.split("Add a depth image")[0]
