# SPDX-License-Identifier: BSD-3-Clause
"""Clouds for the tests."""
import numpy as np


def sphere(center, radius, n=2400, seen_from=-1.0):
    """About half of n points on a sphere (m), N x 3 float64: its front, towards -y."""
    i = np.arange(n)
    z = 1 - (2 * i + 1) / n
    s, a = np.sqrt(1 - z * z), 2.3999632 * i
    d = np.c_[s * np.cos(a), s * np.sin(a), z]
    return np.asarray(center) + radius * d[d[:, 1] * seen_from > -0.2]


def two_fruit(n=2400):
    """Two touching spheres of 35 mm, seen from (0, 0, 0.2)."""
    return np.concatenate([sphere((x, 0.5, 0.2), 0.035, n) for x in (-0.035, 0.035)])
