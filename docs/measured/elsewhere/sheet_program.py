"""What the programs of sheets share: their meshes, and the time of the processor."""

import resource

import numpy as np


def cpu():
    use = resource.getrusage(resource.RUSAGE_SELF)
    return use.ru_utime + use.ru_stime


def obj(path):
    points, faces = [], []
    for line in open(path):
        words = line.split()
        if words[0] == "v":
            points.append([float(word) for word in words[1:]])
        else:
            faces.append([int(word) - 1 for word in words[1:]])
    return np.array(points), np.array(faces)
