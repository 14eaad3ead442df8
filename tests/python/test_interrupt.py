# SPDX-License-Identifier: BSD-3-Clause
"""Ctrl-C stops long work within 50 ms, and the process goes on."""
import os
import signal
import statistics
import subprocess
import sys
import time

import pytest

PROGRAM = """
import sys, time
sys.path.insert(0, {here!r})
import agrisee, numpy
from clouds import two_fruit
cloud = two_fruit(1200000).astype(numpy.float32)
small = two_fruit().astype(numpy.float32)
for _ in range({trials}):
    print("begin", flush=True)
    try:
        agrisee.process(cloud, viewpoint=(0, 0, 0.2), threads={threads})
        print("finished", flush=True)
    except KeyboardInterrupt:
        print(time.monotonic(), flush=True)
print(len(agrisee.process(small, viewpoint=(0, 0, 0.2)).fruits), flush=True)
"""


REACH = """
import sys, time
import agrisee
scene = agrisee.make_truss(sys.argv[1], total=1, hidden=0, seed=1)
slow = []

def reach(request, joints):
    if slow:
        time.sleep(0.005)
    return agrisee.ReachableView(request.pose, request.target)

pipeline = agrisee.Pipeline(scene, {{"gain": {{"candidates": 300}}}}, reach=reach)
camera = agrisee.SimulatedCamera(scene)
view = pipeline.next_view()
pipeline.observe(camera.capture(view.pose), view.pose)
slow.append(True)
for _ in range({trials}):
    print("begin", flush=True)
    try:
        pipeline.next_view()
        print("finished", flush=True)
    except KeyboardInterrupt:
        print(time.monotonic(), flush=True)
slow.clear()
assert pipeline.next_view() is not None and len(pipeline.views) == 1
print(2, flush=True)
"""


NEAREST = """
import time
import agrisee, numpy
n = 400
u, v = numpy.meshgrid(numpy.linspace(0, 2 * numpy.pi, n), numpy.linspace(0, numpy.pi, n))
vertices = numpy.c_[(numpy.cos(u) * numpy.sin(v)).ravel(), (numpy.sin(u) * numpy.sin(v)).ravel(), numpy.cos(v).ravel()]
i = numpy.arange(n * n).reshape(n, n)
a, b, c, d = (x.ravel() for x in (i[:-1, :-1], i[1:, :-1], i[1:, 1:], i[:-1, 1:]))
sphere = agrisee.Bvh(vertices, numpy.r_[numpy.c_[a, b, c], numpy.c_[a, c, d]])
middle = numpy.zeros((10000, 3))  # all triangles are equally near: each query takes some 20 ms
for _ in range({trials}):
    print("begin", flush=True)
    try:
        sphere.nearest(middle, threads=1)
        print("finished", flush=True)
    except KeyboardInterrupt:
        print(time.monotonic(), flush=True)
print(2, flush=True)
"""


def delays_of(command, trials):
    """Seconds from each signal to the exception in a program that tells when it begins and when it was interrupted."""
    child = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    delays = []
    for trial in range(trials):
        assert child.stdout.readline() == "begin\n"
        time.sleep(0.05 + 0.15 * trial)
        sent = time.monotonic()
        child.send_signal(signal.SIGINT)
        answer = child.stdout.readline()
        assert answer != "finished\n", "the work was over before it was interrupted"
        delays.append(float(answer) - sent)
    assert child.stdout.readline() == "2\n"
    assert child.wait() == 0
    print("ms from the signal to the exception:", [round(1e3 * d, 1) for d in delays])
    return delays


@pytest.mark.parametrize("threads", [1, 2])
def test_process(threads):
    here = os.path.dirname(os.path.abspath(__file__))
    program = PROGRAM.format(here=here, trials=6, threads=threads)
    assert statistics.median(delays_of([sys.executable, "-c", program], 6)) < 0.05


def test_next_view_with_a_reach_in_python(tmp_path):
    program = REACH.format(trials=4)
    assert statistics.median(delays_of([sys.executable, "-c", program, str(tmp_path)], 4)) < 0.05


def test_nearest_points_of_a_mesh():
    assert statistics.median(delays_of([sys.executable, "-c", NEAREST.format(trials=4)], 4)) < 0.05
