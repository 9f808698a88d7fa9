"""Writes a sparse OpenVDB cache of a rising, crumpled flame: write.py CELLS FRAMES FOLDER.

Grids: flame (0 to 1, rising over eight voxels), density and vel, as simulators write them: 32 bits, Blosc, active where
there is smoke. The front crumples in waves down to six voxels, at any size.
"""

import sys

import numpy
import pyopenvdb

FRAMES_HZ = 24
LARGEST_WAVES = 3  # along an edge
OCTAVES = 5
WAVES_PER_OCTAVE = 4
EDGE_M = 2.0


def waves(cells):
    random = numpy.random.default_rng(1)
    octaves = OCTAVES + int(round(numpy.log2(cells / 300)))
    for octave in range(octaves):
        for _ in range(WAVES_PER_OCTAVE):
            number = 2 * numpy.pi * LARGEST_WAVES * 2**octave * random.uniform(0.7, 1.4)
            direction = random.normal(size=3)
            direction /= numpy.linalg.norm(direction)
            yield number * direction, 0.022 * 2 ** (-0.85 * octave), random.uniform(0, 2 * numpy.pi), 0.6 * number


def inside(cells, time_s, moving):
    """Distance from the front, in edges of the box; positive in the flame."""
    across = ((numpy.arange(cells) + 0.5) / cells - 0.5).astype(numpy.float32)
    up = ((numpy.arange(cells) + 0.5) / cells).astype(numpy.float32)
    radius = (0.065 + 0.18 * numpy.sqrt(up)) * (1 - up**6)
    distance = radius[None, None, :] - numpy.hypot(across[:, None], across[None, :])[:, :, None]
    for number, height, phase, speed in moving:
        x, y, z = (
            numpy.exp(1j * number[axis] * along).astype(numpy.complex64) for axis, along in enumerate((across, across, up))
        )
        z *= numpy.complex64(height * numpy.exp(1j * (phase - speed * time_s)))
        plane = x[:, None] * y[None, :]
        for row, out in zip(plane, distance):
            out += (row[:, None] * z[None, :]).real
    return distance


def grid(kind, name, values, cells):
    made = kind()
    made.name = name
    made.copyFromArray(values)
    made.transform = pyopenvdb.createLinearTransform(EDGE_M / cells)
    return made


def main(cells, frames, folder):
    moving = list(waves(cells))
    for frame in range(1, frames + 1):
        distance = inside(cells, frame / FRAMES_HZ, moving)
        smoke = numpy.clip(distance * cells / 12 + 1, 0, 1)
        smoke[smoke <= 0.02] = 0
        flame = numpy.clip(distance * cells / 8 + 0.5, 0, 1)
        vel = numpy.zeros(distance.shape + (3,), numpy.float32)
        vel[..., 2] = 3 * distance
        vel[..., 0] = numpy.roll(distance, cells // 7, 1)
        vel[..., 1] = numpy.roll(distance, cells // 5, 2)
        vel[smoke == 0] = 0
        grids = [
            grid(pyopenvdb.FloatGrid, "flame", flame, cells),
            grid(pyopenvdb.FloatGrid, "density", smoke, cells),
            grid(pyopenvdb.Vec3SGrid, "vel", vel, cells),
        ]
        pyopenvdb.write(f"{folder}/fire.{frame:04d}.vdb", grids)
        print(grids[2].activeVoxelCount(), flush=True)


main(int(sys.argv[1]), int(sys.argv[2]), sys.argv[3])
