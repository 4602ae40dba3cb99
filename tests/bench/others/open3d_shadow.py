"""One shadowed point light at every vertex by Open3D's raycasting, as one would write it today.

    python3 open3d_shadow.py mesh.ply        (Debian's Open3D: with ray_mask.cpp preloaded)

Prints a line `TIMES import read tree rays` in seconds, and `BLOCKED n of m`.
"""

import sys
import time

began = time.perf_counter()
times = []


def lap():
    global began
    now = time.perf_counter()
    times.append(now - began)
    began = now


import numpy
import open3d

lap()
mesh = open3d.io.read_triangle_mesh(sys.argv[1])
lap()
scene = open3d.t.geometry.RaycastingScene()
scene.add_triangles(open3d.t.geometry.TriangleMesh.from_legacy(mesh))
places, normals = numpy.asarray(mesh.vertices), numpy.asarray(mesh.vertex_normals)
to_light = numpy.array([0.3, -0.2, 0.35]) - places
faces_it = (to_light * normals).sum(axis=1) > 0
rays = numpy.concatenate([places + 1e-5 * normals, to_light], axis=1)[faces_it].astype(numpy.float32)
scene.test_occlusions(open3d.core.Tensor(rays[:1]))  # the tree is built by the first question
lap()
blocked = scene.test_occlusions(open3d.core.Tensor(rays), tnear=0.0, tfar=1.0).numpy()
lap()
print("TIMES", *times)
print("BLOCKED", int(blocked.sum()), "of", len(rays))
