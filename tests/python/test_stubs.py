# SPDX-License-Identifier: BSD-3-Clause
"""The type stubs say what the module has, and programs are checked with them."""
import os
import subprocess
import sys

import pytest

pytest.importorskip("mypy")
PROGRAM = """
import agrisee
import numpy as np

result = agrisee.process(np.zeros((3, 3), np.float32), viewpoint=(0, 0, 0.2), radius=[0.01, 0.03])
for fruit in result.fruits:
    if fruit.body is not None:
        print(fruit.body.radii.mean(), fruit.pose @ np.eye(4))
parameters = agrisee.Parameters("paper", max_views=3)
parameters.gain.expected.voxel = 0.02
pipeline = agrisee.Pipeline("scene.yaml", parameters, reach=lambda request, joints: agrisee.ReachableView(request.pose))
view = pipeline.next_view()
if view is not None:
    pipeline.observe(np.zeros((3, 4), np.uint16), view.pose, view.joints, depth_scale=0.001)
"""


def run(*arguments, cwd):
    environment = {**os.environ, "MYPYPATH": os.environ["PYTHONPATH"]}
    return subprocess.run([sys.executable, "-m", *arguments], capture_output=True, text=True, cwd=cwd, env=environment)


def test_stubs_agree_with_the_module(tmp_path):
    told = run("mypy.stubtest", "agrisee", "--concise", cwd=tmp_path).stdout.splitlines()
    # What pybind11 does to every class: a metaclass of its own, and an __init__ that raises where there is none.
    usual = ("metaclass differs", '.__init__ is inconsistent, stub does not have *args argument "args"')
    assert any(line.startswith("agrisee._agrisee.Fruit ") for line in told)  # it has run
    assert [line for line in told if not line.endswith(usual)] == []


def test_parameters_are_in_the_stubs():
    done = subprocess.run([sys.executable, "-B", os.path.join(os.path.dirname(os.path.abspath(__file__)), "parameter_stubs.py"), "--check"],
                          capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


def test_programs_are_checked(tmp_path):
    good, bad = tmp_path / "good.py", tmp_path / "bad.py"
    good.write_text(PROGRAM)
    bad.write_text("import agrisee\nagrisee.process([[0.0, 0.0, 0.0]]).fruits[0].radius\nagrisee.process(3)\n")
    done = run("mypy", "--strict", "good.py", cwd=tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr
    done = run("mypy", "bad.py", cwd=tmp_path)
    assert done.stdout.count("error:") == 2 and '"Fruit" has no attribute "radius"' in done.stdout
