"""The cases in MuJoCo, from the MJCF that `fallwerk export` writes; hinges by a compiled callback (hinge.c)."""

import copy
import ctypes
import json
import re
import subprocess
from pathlib import Path

import mujoco
import numpy as np

from common import Watch, row

POINTS = 16
ENERGY = int(mujoco.mjtEnableBit.mjENBL_ENERGY)


class Hinge(ctypes.Structure):
    _fields_ = [
        ("q", ctypes.c_int * 2),
        ("v", ctypes.c_int * 2),
        ("turns", ctypes.c_int),
        ("equality", ctypes.c_int),
        ("points", ctypes.c_int),
        ("axis", ctypes.c_double * 3),
        ("start", ctypes.c_double * 4),
        ("stiffness", ctypes.c_double),
        ("capacity", ctypes.c_double * (2 * POINTS)),
        ("fracture", ctypes.c_double),
        ("plastic", ctypes.c_double * 3),
        ("largest", ctypes.c_double * 3),
        ("broken", ctypes.c_int),
    ]


def library(build):
    """hinge.c compiled against the installed MuJoCo."""
    package = Path(mujoco.__file__).parent
    own = next(package.glob("libmujoco.so*"))
    target = Path(build) / "hinge.so"
    source = Path(__file__).with_name("hinge.c")
    command = ["cc", "-O2", "-shared", "-fPIC", f"-I{package / 'include'}", str(source), str(own), f"-Wl,-rpath,{package}", "-lm", "-o", str(target)]
    subprocess.run(command, check=True)
    lib = ctypes.CDLL(str(target))
    lib.hinge_run.argtypes = [ctypes.c_void_p, ctypes.c_void_p, ctypes.c_int]
    lib.hinge_elastic.argtypes = [ctypes.c_void_p]
    lib.hinge_elastic.restype = ctypes.c_double
    lib.hinge_first_fracture.restype = ctypes.c_double
    return lib


def export(program, case, loose):
    command = [program, "export", str(case.file), "--to", "mjcf"] + (["--loose"] if loose else [])
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def hinges(case, m, d):
    """The model file's hinges on the joints of the MuJoCo model."""
    orientation = lambda name: case.bodies[name]["orientation"] if name else [1.0, 0.0, 0.0, 0.0]
    for force in case.model["forces"]:
        if force["kind"] != "hinge":
            continue
        h = Hinge(stiffness=force["stiffness_nm_rad"], fracture=force["fracture_rad"] or 0.0, equality=-1)
        for i, point in enumerate(force["capacity"]):
            h.capacity[2 * i], h.capacity[2 * i + 1] = point
        h.points = len(force["capacity"])
        for side, name in enumerate([force["body_a"], force["body_b"]]):
            h.q[side] = h.v[side] = -1
            if name is not None:
                joint = m.body(name).jntadr[0]
                h.q[side], h.v[side] = m.jnt_qposadr[joint], m.jnt_dofadr[joint]
                if m.jnt_type[joint] == mujoco.mjtJoint.mjJNT_HINGE:
                    h.turns = 1
                    h.axis[:] = d.xaxis[joint]
        inverse, start = np.zeros(4), np.zeros(4)
        mujoco.mju_negQuat(inverse, np.array(orientation(force["body_a"])))
        mujoco.mju_mulQuat(start, inverse, np.array(orientation(force["body_b"])))
        h.start[:] = start
        if force["joint"]:
            h.equality = mujoco.mj_name2id(m, mujoco.mjtObj.mjOBJ_EQUALITY, force["joint"])
        yield h


def flat(text):
    """In the plane one connection closes a loop; the export writes two for a revolute."""
    return re.sub(r' *<connect name="[^"]*:2"[^>]*/>\n', "", text)


def prepare(text, step, integrator, touching):
    m = mujoco.MjModel.from_xml_string(text)
    m.opt.timestep = step
    m.opt.integrator = integrator
    m.eq_solref[:, 0] = 2 * step
    m.geom_solref[:, 0] = 2 * step
    if not touching:
        m.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONTACT)
    m.opt.enableflags |= ENERGY
    d = mujoco.MjData(m)
    if m.nkey:
        mujoco.mj_resetDataKeyframe(m, d, 0)
    mujoco.mj_forward(m, d)
    return m, d


INTEGRATORS = {
    "RK4": mujoco.mjtIntegrator.mjINT_RK4,
    "implicitfast": mujoco.mjtIntegrator.mjINT_IMPLICITFAST,
    "Euler": mujoco.mjtIntegrator.mjINT_EULER,
}


def as_revolute(case, build):
    """The simple pendulum on a revolute with next to no moment of inertia: the form that suits joint coordinates."""
    model = json.loads(case.file.read_text())
    joint, body = model["joints"][0], model["bodies"][0]
    joint.update(kind="revolute", axis=[0, 0, 1])
    joint.pop("point_b_m")
    body["inertia_kg_m2"] = [[1e-12 if i == j else 0.0 for j in range(3)] for i in range(3)]
    other = copy.copy(case)
    other.model, other.file = model, Path(build) / f"{case.name}-revolute.json"
    other.file.write_text(json.dumps(model))
    return other


def smooth(program, case, method, step, lib, native=False):
    """Follows the known path."""
    callback = any(f["kind"] == "hinge" for f in case.model["forces"]) and not native
    text = export(program, case, loose=callback)
    if case.name.startswith(("a02", "a03")):
        text = flat(text)
    m, d = prepare(text, step, INTEGRATORS[method], touching=False)
    if callback:
        # the springs of the export give way to the callback
        m.jnt_stiffness[:] = 0
        m.jnt_springyield[:] = 1e9
        lib.hinge_clear()
        for h in hinges(case, m, d):
            lib.hinge_add(ctypes.byref(h))
    mujoco.mj_forward(m, d)
    energy = lambda: sum(d.energy) + (lib.hinge_elastic(d._address) if callback else 0.0)
    began, worst, places, done, watch = energy(), 0.0, [], 0, Watch()
    m.opt.enableflags &= ~ENERGY
    for known in case.path:
        count = round(known[0] / step)
        with watch:
            if callback:
                lib.hinge_run(m._address, d._address, count - done)
            else:
                mujoco.mj_step(m, d, count - done)
        done = count
        m.opt.enableflags |= ENERGY
        mujoco.mj_forward(m, d)
        m.opt.enableflags &= ~ENERGY
        places.append(d.sensordata[:3].copy())
        worst = max(worst, abs(energy() - began))
    conservative = case.name not in ("a03-squeezer", "topple-flow", "frame4")
    label = f"{method}{', compiled hinge' if callback else ', springyield' if native else ''}"
    return row(case, "MuJoCo", label, step, watch.spent, case.error_m(places), worst if conservative else None)


def pile(program, case, step, solver):
    """Lets the pile fall; largest penetration in the last second."""
    text = export(program, case, loose=False)
    m, d = prepare(text, step, INTEGRATORS["implicitfast"], touching=True)
    m.opt.enableflags = 0
    m.opt.solver = solver
    m.opt.tolerance = 1e-8
    m.opt.iterations = 50
    watch, deepest = Watch(), 0.0
    for i in range(round(case.end_s / step)):
        with watch:
            mujoco.mj_step(m, d)
        if i * step > case.end_s - 1.0 and d.ncon:
            deepest = max(deepest, -float(np.min(d.contact.dist)))
        if watch.spent > 300.0:
            return None
    label = "implicitfast, " + ("CG" if solver == mujoco.mjtSolver.mjSOL_CG else "Newton")
    return row(case, "MuJoCo", label, step, watch.spent, note=f"penetration {1e3 * deepest:.2f} mm")
