"""A sheet in PositionBasedDynamics: pbd_sheet.py SCENE SHEET.obj SUBSTEPS TIME CAP OUT [BALL.obj]

SCENE is hang or ball (without contact of the sheet with itself, which the program does not have for sheets). Frames of
5 ms in SUBSTEPS of one iteration each. Prints `cpu time steps` of the loop of steps, and writes to OUT the time and
all positions of every frame, in doubles. Gravity is 9.81 m/s2, which cannot be changed from Python.
"""

import os
import sys

os.environ["OMP_NUM_THREADS"] = "1"

import numpy as np
import pypbd as pbd
from sheet_program import cpu, obj


def main():
    scene, mesh, substeps, end, cap, out = sys.argv[1:7]
    substeps, end, cap = int(substeps), float(end), float(cap)
    points, faces = obj(mesh)
    corner = int(np.argmin(np.linalg.norm(points - [0, 1, 0], axis=1)))
    # Gravity acts along -y there: (x, y, z) becomes (x, z, -y).
    points = points[:, [0, 2, 1]] * [1, 1, -1]
    a, b, c = (points[faces[:, i]] for i in range(3))
    third = np.linalg.norm(np.cross(b - a, c - a), axis=1) / 6
    shares = np.zeros(len(points))
    for i in range(3):
        np.add.at(shares, faces[:, i], third)

    simulation = pbd.Simulation.getCurrent()
    simulation.initDefault()
    model = simulation.getModel()
    sheet = model.addTriangleModel(points, faces.flatten(), testMesh=False)
    particles = model.getParticles()
    for i, share in enumerate(shares / shares.sum()):
        particles.setMass(i, 0.1 * share)
    if scene == "hang":
        particles.setMass(corner, 0.0)
    # Distances of 3e5 N/m, isometric bending of D / 3.
    model.addClothConstraints(sheet, 4, 3e5, 0.0, 0.0, 0.0, 0.0, 0.0, False, False)
    model.addBendingConstraints(sheet, 3, 5e-5 / 3)
    stepper = simulation.getTimeStep()
    stepper.setValueUInt(pbd.TimeStepController.NUM_SUB_STEPS, substeps)
    stepper.setValueUInt(pbd.TimeStepController.MAX_ITERATIONS, 1)
    if scene == "ball":
        detection = pbd.DistanceFieldCollisionDetection()
        detection.setTolerance(0.001)
        corners, mesh = pbd.OBJLoader.loadObjToMesh(sys.argv[7], [1, 1, 1])
        body = model.addRigidBody(1.0, corners, mesh, np.array([0.5, -0.2, -0.5]), np.identity(3), np.ones(3))
        body.setMass(0.0)
        body.setRestitutionCoeff(0.0)
        body.setFrictionCoeff(0.3)
        sheet.setFrictionCoeff(0.3)
        sheet.setRestitutionCoeff(0.0)
        vertices = body.getGeometry().getVertexDataLocal()
        kind = pbd.CollisionObject.RigidBodyCollisionObjectType
        detection.addCollisionSphere(0, kind, vertices, 0, vertices.size(), 0.2, True, False)
        kind = pbd.CollisionObject.TriangleModelCollisionObjectType
        detection.addCollisionObjectWithoutGeometry(0, kind, particles, 0, len(points), True)
        stepper.setCollisionDetection(model, detection)
    pbd.TimeManager.getCurrent().setTimeStepSize(0.005)

    frames = [(0.0, points)]
    begun, took, done = cpu(), 0.0, 0
    for done in range(1, round(end / 0.005) + 1):
        stepper.step(model)
        frames.append((done * 0.005, np.array([particles.getPosition(i) for i in range(len(points))])))
        took = cpu() - begun
        if took > cap:
            break
    with open(out, "wb") as file:
        for time, positions in frames:
            positions = positions[:, [0, 2, 1]] * [1, -1, 1]
            file.write(np.float64(time).tobytes() + np.ascontiguousarray(positions, dtype=float).tobytes())
    print(f"{took:.4f} {done * 0.005:.6f} {done * substeps}")


main()
