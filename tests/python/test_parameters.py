# SPDX-License-Identifier: BSD-3-Clause
"""Parameters: attributes, dicts, YAML, presets."""
import copy
import errno
import os
import pickle
from collections import UserDict
from types import MappingProxyType

import agrisee
import numpy as np
import pytest
from agrisee import Parameters


def leaves(values, prefix=""):
    for key, value in values.items():
        if isinstance(value, dict):
            yield from leaves(value, prefix + key + ".")
        else:
            yield prefix + key, value


def test_every_key_is_an_attribute():
    parameters = Parameters()
    count = 0
    for key, value in leaves(parameters.to_dict()):
        *groups, name = key.split(".")
        owner = parameters
        for group in groups:
            owner = getattr(owner, group)
        assert getattr(owner, name) == value, key
        assert name in dir(owner)
        if key != "preset":
            setattr(owner, name, value)
        count += 1
    assert count > 80 and parameters == Parameters()


def test_groups_refer_to_the_whole():
    parameters = Parameters()
    gain = parameters.gain
    gain.min_gain = 0.003
    assert parameters.gain.min_gain == 0.003 and parameters.to_dict()["gain"]["min_gain"] == 0.003
    parameters.split.bodies.fit = {"noise": 0.001}
    assert parameters.split.bodies.fit.noise == 0.001
    other = Parameters()
    other.gain = gain
    assert other.gain == gain and other.gain.min_gain == 0.003
    del parameters
    gain.min_gain = 0.004
    assert gain.min_gain == 0.004 and other.gain.min_gain == 0.003


def test_presets():
    assert Parameters("paper").planner == "see" and Parameters("paper").preset == "paper"
    assert Parameters("see", max_views=9).max_views == 9
    assert Parameters.from_dict({"preset": "paper", "max_views": 3}).sor.std_ratio == 2.0
    assert Parameters.from_yaml("preset: paper\n") == Parameters("paper")
    assert repr(Parameters("paper", gain={"min_gain": 0.5})) == "Parameters('paper', gain.min_gain=0.5)"


def test_dicts_and_yaml_read_back(tmp_path):
    parameters = Parameters(max_views=7, icp=dict(kernel="huber"), **{"split.bodies.fit.noise": 0.0013})
    assert Parameters.from_dict(parameters.to_dict()) == parameters
    assert Parameters.from_yaml(parameters.to_yaml()) == parameters
    path = tmp_path / "p.yaml"
    path.write_text(parameters.to_yaml())
    assert Parameters.from_yaml(path) == Parameters.from_yaml(str(path)) == parameters
    assert pickle.loads(pickle.dumps(parameters)) == parameters
    for twin in (copy.copy(parameters), copy.deepcopy(parameters), parameters.copy()):
        twin.max_views = 8
        assert twin != parameters and parameters.max_views == 7


def test_groups_are_pickled_and_copied():
    parameters = Parameters(**{"split.bodies.fit.noise": 0.0013})
    for twin in (pickle.loads(pickle.dumps(parameters.split)), copy.copy(parameters.split), copy.deepcopy(parameters.split)):
        assert twin == parameters.split and twin.bodies.fit.noise == 0.0013
        twin.bodies.fit.noise = 0.002  # of its own
        assert parameters.split.bodies.fit.noise == 0.0013
        with pytest.raises(agrisee.ParameterError, match="split.bodies.fit.noise must be"):
            twin.bodies.fit.noise = -1


def test_any_mapping_is_taken():
    values = MappingProxyType({"gain": UserDict(min_gain=0.003), "split.bodies": MappingProxyType({"fit": {"noise": 0.002}})})
    wanted = Parameters(gain={"min_gain": 0.003}, split={"bodies": {"fit": {"noise": 0.002}}})
    updated = Parameters()
    updated.update(values)
    assert Parameters.from_dict(values) == Parameters(**values) == updated == wanted
    updated.gain.update(MappingProxyType({"min_gain": 0.004}))
    assert updated.gain.min_gain == 0.004
    assert agrisee.process([], parameters=values).fruits == []
    for call, name in ((Parameters.from_dict, "values"), (updated.update, "values"), (updated.gain.update, "values"), (agrisee.Workcell.from_dict, "values")):
        with pytest.raises(TypeError, match=f"^{name} must be a dict or another mapping, got 3"):
            call(3)
    with pytest.raises(agrisee.ParameterError, match="unknown key 'gain.nose'"):
        Parameters.from_dict(MappingProxyType({"gain": MappingProxyType({"nose": 1})}))


def test_numbers_of_numpy():
    parameters = Parameters()
    parameters.max_views = np.int64(5)
    parameters.gain.min_gain = np.float32(0.25)
    parameters.growth_axis = np.bool_(False)
    parameters.truss_gap = 2
    assert (parameters.max_views, parameters.gain.min_gain, parameters.growth_axis, parameters.truss_gap) == (5, 0.25, False, 2.0)


@pytest.mark.parametrize("key, value, error, words", [
    ("gain.min_gain", -1, agrisee.ParameterError, "gain.min_gain must be zero or more, got -1"),
    ("gain.min_gain", float("nan"), agrisee.ParameterError, "gain.min_gain must be a finite number"),
    ("gain.min_gain", "x", TypeError, "gain.min_gain must be a number, got 'x'"),
    ("gain.min_gain", True, TypeError, "gain.min_gain must be a number, got True"),
    ("gain.candidates", 2.5, TypeError, "gain.candidates must be a whole number, got 2.5"),
    ("gain.candidates", 10**30, agrisee.ParameterError, "gain.candidates is out of range"),
    ("gain.candidates", 2**40, agrisee.ParameterError, "gain.candidates is out of range"),
    ("icp.kernel", "cubic", agrisee.ParameterError, "icp.kernel must be none, huber or tukey, got cubic"),
    ("growth_axis", 1, TypeError, "growth_axis must be True or False, got 1"),
    ("planner", "best", agrisee.ParameterError, "planner must be"),
    ("split.bodies", 3, TypeError, "split.bodies must be a dict of parameters, got 3"),
    ("split.bodies.fit.nose", 3, agrisee.ParameterError, "unknown key 'split.bodies.fit.nose'; did you mean 'noise'?"),
    ("normals.radius", 6.0, agrisee.ParameterError, "normals.radius must be"),
])
def test_errors_name_the_whole_key(key, value, error, words):
    nested = value
    for name in reversed(key.split(".")):
        nested = {name: nested}
    parameters = Parameters()
    for attempt in (lambda: Parameters.from_dict(nested), lambda: Parameters(**nested), lambda: parameters.update(nested),
                    lambda: parameters.update({key: value}), lambda: agrisee.process([], parameters=nested)):
        with pytest.raises(error) as caught:
            attempt()
        assert words in str(caught.value)
    assert parameters == Parameters()  # nothing was changed


def test_attributes_are_tested_when_they_are_set():
    parameters = Parameters()
    with pytest.raises(agrisee.ParameterError, match="gain.expected.voxel must be"):
        parameters.gain.expected.voxel = -1
    with pytest.raises(AttributeError, match="unknown key 'gain.min_gian'; did you mean 'min_gain'"):
        parameters.gain.min_gian = 1
    with pytest.raises(AttributeError, match="unknown key 'gian'"):
        parameters.gian
    assert parameters == Parameters()
    for change in (lambda: setattr(parameters, "preset", "paper"), lambda: parameters.update({"preset": "paper"})):
        with pytest.raises(agrisee.ParameterError, match="preset cannot be changed"):
            change()
    parameters.expect_radii(0.01, 0.02)
    assert parameters.split.bodies.radius_max == 0.02


def test_a_missing_file_is_pythons(tmp_path):
    path = tmp_path / "ä none.yaml"
    for read in (Parameters.from_yaml, agrisee.Workcell.from_yaml, agrisee.Pipeline, agrisee.SimulatedCamera, agrisee.scan):
        with pytest.raises(FileNotFoundError, match=r"^/.*ä none\.yaml: no such file") as caught:
            read(path)
        error = caught.value
        assert type(error) is agrisee.MissingFileError and isinstance(error, agrisee.FileError)
        assert error.errno == errno.ENOENT and error.filename == str(path)
        assert str(pickle.loads(pickle.dumps(error))) == str(error)
    with pytest.raises(FileNotFoundError) as caught:
        agrisee.Workcell.from_yaml(os.fsdecode(b"/none/\xff.yaml"))  # no UTF-8
    assert caught.value.filename == os.fsdecode(b"/none/\xff.yaml")
    with pytest.raises(agrisee.FileError, match="^/.*: is a directory") as caught:
        Parameters.from_yaml(tmp_path)
    assert not isinstance(caught.value, FileNotFoundError)


def test_errors_of_yaml(tmp_path):
    with pytest.raises(agrisee.ParameterError, match="YAML:2: unknown key 'gain.foo'"):
        Parameters.from_yaml("gain:\n  foo: 1\n")
    with pytest.raises(agrisee.FileError, match="no such file"):
        Parameters.from_yaml(tmp_path / "none.yaml")
    bad = tmp_path / "bad.yaml"
    bad.write_text("gain:\n  min_gain: -1\n")
    with pytest.raises(OSError, match="bad.yaml:2: 'gain.min_gain' must be zero or more, got -1"):
        Parameters.from_yaml(bad)
