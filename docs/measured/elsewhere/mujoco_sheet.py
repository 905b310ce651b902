"""A sheet as a flex in MuJoCo: mujoco_sheet.py SCENE SHEET.obj STEP TIME CAP OUT [ipc]

SCENE is hang, ball, table or strip. Prints `cpu time steps` of the loop of steps, and writes to OUT, for a hundred
times of the run, the time and all positions, in doubles. With `ipc` MuJoCo's experimental contact without
penetration and friction takes the place of the contact by penalties.
"""

import os
import sys

os.environ["OMP_NUM_THREADS"] = "1"

import mujoco
import numpy as np
from sheet_program import cpu, obj


def model(scene, points, faces, step, ipc):
    strip = scene == "strip"
    # Thickness and Young's modulus with the membrane stiffness E h and the rigidity E h^3 / (12 (1 - nu^2)).
    stiffness, rigidity = 3e5, 5e-4 if strip else 5e-5
    thickness = np.sqrt(12 * (1 - 0.3**2) * rigidity / stiffness)
    mass = 0.08 * 0.3 * 0.03 if strip else 0.1
    radius = 5e-5 if strip else 5e-4
    pins = ""
    if scene == "hang":
        corner = np.argmin(np.linalg.norm(points - [0, 1, 0], axis=1))
        pins = f'<pin id="{corner}"/>'
    elif strip:
        held = np.flatnonzero(points[:, 0] < 0.0026)
        pins = f'<pin id="{" ".join(map(str, held))}"/>'
    body = {
        "ball": '<geom type="sphere" size="0.2" pos="0.5 0.5 -0.2" friction="0.3 0 0" solref="0.004 1" '
        'solimp=".95 .99 .0001"/>',
        "table": '<geom type="box" size="0.25 0.25 0.1" pos="0.5 0.5 -0.101" friction="0.3 0 0" '
        'solref="0.004 1" solimp=".95 .99 .0001"/>',
    }.get(scene, "")
    off = 'contype="0" conaffinity="0" selfcollide="none"'
    on = f'selfcollide="auto" passive="{"false" if ipc else "true"}" friction="0.3 0 0"'
    contact = off if scene == "hang" else on
    flags = '<flag ipc="enable"/>' if ipc else ""
    numbers = lambda rows: " ".join(f"{number:.17g}" for number in np.ravel(rows))
    return mujoco.MjModel.from_xml_string(f"""<mujoco>
  <option timestep="{step:.17g}" gravity="0 0 -9.8" solver="CG" tolerance="1e-6" iterations="100"
    integrator="discrete">{flags}</option>
  <size memory="400M"/>
  <worldbody>
    {body}
    <flexcomp name="sheet" type="direct" dim="2" mass="{mass}" radius="{radius}"
      point="{numbers(points)}" element="{' '.join(map(str, np.ravel(faces)))}">
      <contact {contact} solref="0.004 1" solimp=".95 .99 .0001"/>
      <elasticity young="{stiffness / thickness:.17g}" poisson="0.3" thickness="{thickness:.17g}" elastic2d="both"/>
      {pins}
    </flexcomp>
  </worldbody>
</mujoco>""")


def lumped(points, faces):
    """A third of the area of every face for each of its corners."""
    a, b, c = (points[faces[:, i]] for i in range(3))
    third = np.linalg.norm(np.cross(b - a, c - a), axis=1) / 6
    areas = np.zeros(len(points))
    for i in range(3):
        np.add.at(areas, faces[:, i], third)
    return areas / areas.sum()


def main():
    scene, mesh, step, end, cap, out = sys.argv[1:7]
    step, end, cap = float(step), float(end), float(cap)
    points, faces = obj(mesh)
    sheet = model(scene, points, faces, step, "ipc" in sys.argv[7:])
    # Vertices have equal masses by default: lump them by thirds, as in the other programs.
    mass = 0.08 * 0.3 * 0.03 if scene == "strip" else 0.1
    shares = lumped(points, faces)
    led = []
    for vertex, body in enumerate(sheet.flex_vertbodyid):
        if body == 0 or sheet.body_dofnum[body] == 0:
            continue
        scale = shares[vertex] * mass / sheet.body_mass[body]
        if scene == "strip" and points[vertex, 0] > 0.2974:
            # The end of the strip that is led: heavy, and set to its place and velocity before every step.
            scale *= 1e4
            led.append(sheet.body_dofadr[body])
        sheet.body_mass[body] *= scale
        sheet.body_inertia[body] *= scale
    led = np.array(led, dtype=int)
    data = mujoco.MjData(sheet)
    mujoco.mj_setConst(sheet, data)
    mujoco.mj_forward(sheet, data)
    every = max(1, round(end / step / 100))
    frames = [(0.0, data.flexvert_xpos.copy())]
    count = round(end / step)
    begun, took, done = cpu(), 0.0, 0
    for done in range(1, count + 1):
        if len(led):
            part = min((done - 1) * step / 1.5, 1.0)
            for axis in range(3):
                data.qpos[led + axis] = -0.27 * part if axis == 0 else 0.0
                data.qvel[led + axis] = -0.18 if axis == 0 and part < 1.0 else 0.0
        mujoco.mj_step(sheet, data)
        if done % every == 0 or done == count:
            took = cpu() - begun
            # Positions are those of the start of the step until they are computed anew.
            mujoco.mj_kinematics(sheet, data)
            mujoco.mj_flex(sheet, data)
            frames.append((data.time, data.flexvert_xpos.copy()))
            if took > cap:
                break
    took = cpu() - begun
    with open(out, "wb") as file:
        for time, positions in frames:
            file.write(np.float64(time).tobytes() + np.ascontiguousarray(positions).tobytes())
    warned = [str(mujoco.mjtWarning(i)) for i in range(len(data.warning)) if data.warning[i].number]
    print(f"{took:.4f} {data.time:.6f} {done}", *warned)


main()
