#!/usr/bin/env python3
"""Writes the volume correlation of a pulled rubber block as tables that Lacuna reads.

The data are those of M. Bourdyot, M. Compans, R. Langlois, B. Smaniotto, E. Baranger and C. Jailin, "Learning a
hyperelastic constitutive model from 3D experimental data" (cjailin/Experimental_PANN_learning, folder DVC_data,
GPL-3.0), and are not part of this project. Voxels of 30 micrometres; the forces are those in their program.

    pulled_block.py DVC_data $LACUNA_DATA/pulled_block
"""
import collections
import pathlib
import sys

VOXEL_MM = 30e-3
FORCES_N = [0, 280, 590, 863, 1110]


def read_rows(path, columns):
    lines = path.read_text().split()
    return [[float(value) for value in line.split(",")[:columns]] for line in lines]


def boundary_of(tetrahedra):
    """The faces that belong to one tetrahedron only, turned outwards."""
    faces = {}
    count = collections.Counter()
    for a, b, c, d in tetrahedra:
        for face in ((a, c, b), (a, b, d), (b, c, d), (a, d, c)):
            key = tuple(sorted(face))
            faces[key] = face
            count[key] += 1
    return [faces[key] for key in faces if count[key] == 1]


def is_left_handed(points, tetrahedron):
    origin, *others = (points[i] for i in tetrahedron)
    (ax, ay, az), (bx, by, bz), (cx, cy, cz) = ([q - p for p, q in zip(origin, other)] for other in others)
    return ax * (by * cz - bz * cy) - ay * (bx * cz - bz * cx) + az * (bx * cy - by * cx) < 0


def main(source, target):
    target.mkdir(parents=True, exist_ok=True)
    points = read_rows(source / "coordinates_scan1.csv", 3)
    tetrahedra = [[int(i) for i in row] for row in read_rows(source / "connectivity_scan1.csv", 4)]
    first = min(min(row) for row in tetrahedra)
    tetrahedra = [[i - first for i in row] for row in tetrahedra]
    for row in tetrahedra:
        if is_left_handed(points, row):
            row[2], row[3] = row[3], row[2]

    faces = boundary_of(tetrahedra)
    vertices = sorted({i for face in faces for i in face})
    number = {vertex: k for k, vertex in enumerate(vertices)}
    with open(target / "surface.off", "w") as out:
        print(f"OFF\n{len(vertices)} {len(faces)} 0", file=out)
        for vertex in vertices:
            print(*(f"{VOXEL_MM * x:.6f}" for x in points[vertex]), file=out)
        for face in faces:
            print(3, *(number[i] for i in face), file=out)

    for step in range(len(FORCES_N)):
        if step == 0:
            displacements = [[0.0] * 3] * len(points)
        else:
            displacements = read_rows(source / f"displacements_scan{step}-1.csv", 3)
        with open(target / f"frame_{step}.csv", "w") as out:
            print("X,Y,Z,U,V,W", file=out)
            for point, displacement in zip(points, displacements):
                print(",".join(f"{VOXEL_MM * x:.6f}" for x in point + displacement), file=out)
    with open(target / "machine.csv", "w") as out:
        print("t,F", file=out)
        for step, force in enumerate(FORCES_N):
            print(f"{step},{force}", file=out)


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    main(pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]))
