"""The cases in Exudyn, from the model file: redundant coordinates, implicit generalised-alpha."""

import exudyn as exu
import numpy as np
from exudyn.rigidBodyUtilities import RigidBodyInertia

from common import Watch, row


def matrix(q):
    w, x, y, z = np.array(q) / np.linalg.norm(q)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


class Flow:
    """Return mapping of a hinge of one axis inside the Newton iteration; the history is committed once a step."""

    def __init__(self, force):
        self.k = force["stiffness_nm_rad"]
        self.capacity = np.array(force["capacity"])
        self.plastic = self.largest = 0.0

    def limit(self, rotation):
        return np.interp(max(self.largest, abs(rotation)), self.capacity[:, 0], self.capacity[:, 1])

    def moment(self, mbs, t, item, rotation, velocity, *_):
        limit = self.limit(rotation)
        return min(max(self.k * (rotation - self.plastic), -limit), limit)

    def commit(self, rotation):
        moment = self.moment(None, 0, 0, rotation, 0)
        self.largest = max(self.largest, abs(rotation))
        self.plastic = rotation - moment / self.k


def build(case):
    """The system, a sensor of the tracked point, and the hinges with their objects."""
    sc = exu.SystemContainer()
    mbs = sc.AddSystem()
    gravity = case.model["gravity_m_s2"]
    ground = mbs.CreateGround()
    numbers = {None: ground}
    for body in case.model["bodies"]:
        numbers[body["id"]] = mbs.CreateRigidBody(
            referencePosition=body["position_m"],
            referenceRotationMatrix=matrix(body["orientation"]),
            initialVelocity=body["velocity_m_s"],
            initialAngularVelocity=body["angular_velocity_rad_s"],
            inertia=RigidBodyInertia(mass=body["mass_kg"], inertiaTensor=np.array(body["inertia_kg_m2"]), com=[0, 0, 0]),
            gravity=gravity,
        )

    def local(name, point):
        if name is None:
            return list(point)
        body = case.bodies[name]
        return list(matrix(body["orientation"]).T @ (np.array(point) - np.array(body["position_m"])))

    for joint in case.model["joints"]:
        ends = [joint["body_a"], joint["body_b"]]
        both = [numbers[e] for e in ends]
        if joint["kind"] == "revolute":
            mbs.CreateRevoluteJoint(bodyNumbers=both, position=joint["point_m"], axis=joint["axis"], useGlobalFrame=True)
        elif joint["kind"] == "spherical":
            mbs.CreateSphericalJoint(bodyNumbers=both, position=joint["point_m"], useGlobalFrame=True)
        elif joint["kind"] == "rod":
            points = [local(ends[0], joint["point_m"]), local(ends[1], joint["point_b_m"])]
            mbs.CreateDistanceConstraint(bodyNumbers=both, localPosition0=points[0], localPosition1=points[1])
        else:
            raise ValueError(f"no joint of kind {joint['kind']}")
    hinges = []
    for force in case.model["forces"]:
        if force["kind"] == "spring":
            ends = [force["body_a"], force["body_b"]]
            mbs.CreateSpringDamper(
                bodyNumbers=[numbers[e] for e in ends],
                localPosition0=local(ends[0], force["point_a_m"]),
                localPosition1=local(ends[1], force["point_b_m"]),
                referenceLength=force["length_m"],
                stiffness=force["stiffness_n_m"],
                damping=force["damping_n_s_m"],
            )
        elif force["kind"] == "torque":
            mbs.CreateTorque(bodyNumber=numbers[force["body"]], loadVector=force["torque_nm"])
        elif force["kind"] == "hinge":
            joint = next(j for j in case.model["joints"] if j["body_b"] == force["body_b"])
            flow = Flow(force)
            spring = mbs.CreateTorsionalSpringDamper(
                bodyNumbers=[numbers[force["body_a"]], numbers[force["body_b"]]],
                position=joint["point_m"],
                axis=joint["axis"],
                stiffness=0.0,
                damping=0.0,
                useGlobalFrame=True,
                springTorqueUserFunction=flow.moment,
            )
            hinges.append((flow, spring))
    point = case.model["tracked"][0]
    sensor = mbs.AddSensor(
        exu.itemInterface.SensorBody(
            bodyNumber=numbers[point["body"]],
            localPosition=local(point["body"], point["point_m"]),
            outputVariableType=exu.OutputVariableType.Position,
            storeInternal=True,
            writeToFile=False,
        )
    )
    if hinges:

        def committed(mbs, t):
            for flow, spring in hinges:
                flow.commit(mbs.GetObjectOutput(spring, exu.OutputVariableType.Rotation))
            return True

        mbs.SetPreStepUserFunction(committed)
    mbs.Assemble()
    return mbs, sensor


def build_planar(case):
    """The same for a mechanism in the x-y plane, with three coordinates a body."""
    items = exu.itemInterface
    sc = exu.SystemContainer()
    mbs = sc.AddSystem()
    bodies = {None: mbs.AddObject(items.ObjectGround())}
    angles = {None: 0.0}
    spun = {end for j in case.model["joints"] if j["kind"] != "rod" for end in (j["body_a"], j["body_b"])}
    for body in case.model["bodies"]:
        x, y, _ = body["position_m"]
        r = matrix(body["orientation"])
        angle = angles[body["id"]] = float(np.arctan2(r[1, 0], r[0, 0]))
        vx, vy, _ = body["velocity_m_s"]
        if body["id"] in spun:
            turning = body["angular_velocity_rad_s"][2]
            node = mbs.AddNode(items.NodeRigidBody2D(referenceCoordinates=[x, y, angle], initialVelocities=[vx, vy, turning]))
            inertia = body["inertia_kg_m2"][2][2]
            number = mbs.AddObject(items.RigidBody2D(physicsMass=body["mass_kg"], physicsInertia=inertia, nodeNumber=node))
        else:
            node = mbs.AddNode(items.NodePoint2D(referenceCoordinates=[x, y], initialVelocities=[vx, vy]))
            number = mbs.AddObject(items.MassPoint2D(physicsMass=body["mass_kg"], nodeNumber=node))
        bodies[body["id"]] = number
        weight = [body["mass_kg"] * g for g in case.model["gravity_m_s2"]]
        mbs.AddLoad(items.Force(markerNumber=mbs.AddMarker(items.MarkerBodyPosition(bodyNumber=number)), loadVector=weight))

    def local(name, point):
        if name is None:
            return list(point)
        body = case.bodies[name]
        return list(matrix(body["orientation"]).T @ (np.array(point) - np.array(body["position_m"])))

    def marker(kind, name, point):
        return mbs.AddMarker(kind(bodyNumber=bodies[name], localPosition=local(name, point)))

    for joint in case.model["joints"]:
        ends = [joint["body_a"], joint["body_b"]]
        if joint["kind"] == "revolute":
            pair = [marker(items.MarkerBodyRigid if e else items.MarkerBodyPosition, e, joint["point_m"]) for e in ends]
            mbs.AddObject(items.RevoluteJoint2D(markerNumbers=pair))
        else:
            points = [joint["point_m"], joint["point_b_m"]]
            pair = [marker(items.MarkerBodyPosition, e, p) for e, p in zip(ends, points)]
            length = float(np.linalg.norm(np.array(points[1]) - np.array(points[0])))
            mbs.AddObject(items.DistanceConstraint(markerNumbers=pair, distance=length))
    for force in case.model["forces"]:
        if force["kind"] == "spring":
            pair = [marker(items.MarkerBodyPosition, force[f"body_{e}"], force[f"point_{e}_m"]) for e in "ab"]
            law = dict(referenceLength=force["length_m"], stiffness=force["stiffness_n_m"], damping=force["damping_n_s_m"])
            mbs.AddObject(items.SpringDamper(markerNumbers=pair, **law))
        elif force["kind"] == "torque":
            own = mbs.AddMarker(items.MarkerBodyRigid(bodyNumber=bodies[force["body"]]))
            mbs.AddLoad(items.Torque(markerNumber=own, loadVector=force["torque_nm"]))
    point = case.model["tracked"][0]
    sensor = mbs.AddSensor(
        items.SensorBody(
            bodyNumber=bodies[point["body"]],
            localPosition=local(point["body"], point["point_m"]),
            outputVariableType=exu.OutputVariableType.Position,
            storeInternal=True,
            writeToFile=False,
        )
    )
    mbs.Assemble()
    return mbs, sensor


def settings(case, step, radius):
    s = exu.SimulationSettings()
    s.timeIntegration.endTime = case.end_s
    s.timeIntegration.numberOfSteps = round(case.end_s / step)
    s.timeIntegration.generalizedAlpha.spectralRadius = radius
    s.timeIntegration.verboseMode = 0
    s.timeIntegration.newton.useModifiedNewton = True
    s.solutionSettings.writeSolutionToFile = False
    # every step that is an output; a step more or less falls on none
    shortest = min(b - a for a, b in zip([0.0] + [p[0] for p in case.path], [p[0] for p in case.path]))
    s.solutionSettings.sensorsWritePeriod = min(shortest, case.model["settings"]["output_interval_s"])
    s.linearSolverType = exu.LinearSolverType.EigenDense
    s.linearSolverSettings.ignoreSingularJacobian = True
    s.parallel.numberOfThreads = 1
    s.displayComputationTime = False
    return s


def smooth(case, step, radius=0.9, planar=False):
    """Follows the known path."""
    mbs, sensor = (build_planar if planar else build)(case)
    s = settings(case, step, radius)
    if planar:
        # nothing is redundant in the plane, but the pose in which all bars lie on one line
        s.linearSolverType = exu.LinearSolverType.EigenSparse
        s.linearSolverSettings.ignoreSingularJacobian = False
    watch = Watch()
    with watch:
        mbs.SolveDynamic(s)
    stored = mbs.GetSensorStoredData(sensor)
    places = [stored[np.argmin(np.abs(stored[:, 0] - known[0])), 1:4] for known in case.path]
    python = any(f["kind"] == "hinge" for f in case.model["forces"])
    how = "plane, sparse LU" if planar else "space, dense LU"
    label = f"generalised-alpha, {how}{', hinge in Python' if python else ''}"
    return row(case, "Exudyn", label, step, watch.spent, case.error_m(places))
