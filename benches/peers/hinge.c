/* The hinge law of the model file as a passive force of MuJoCo, evaluated at every stage; its history is committed once a step.
 *
 * A hinge acts between two bodies that float (or the world), or about a hinge joint on the world. Rotations are the components, in the frame of
 * the first body, of the rotation vector from the first to the second body since the start. */

#include <math.h>
#include <mujoco/mujoco.h>

#define MOST 256
#define POINTS 16

typedef struct {
  int q[2];          /* address in qpos of the free joint of each body, -1: the world; of the second one the address of a hinge joint if turns */
  int v[2];          /* the same in qvel */
  int turns;         /* whether it acts about a hinge joint */
  int equality;      /* constraint that opens, -1: none */
  int points;        /* of the capacity */
  double axis[3];    /* of the hinge joint in the world */
  double start[4];   /* rotation of the second body against the first at the start */
  double stiffness;
  double capacity[2 * POINTS];
  double fracture;   /* length of the rotation vector, 0: never */
  double plastic[3];
  double largest[3];
  int broken;
} Hinge;

static Hinge hinges[MOST];
static int count;
static double first_fracture;

void hinge_clear(void) {
  count = 0;
  first_fracture = -1;
}

int hinge_add(Hinge const* hinge) {
  if (count == MOST) return -1;
  hinges[count] = *hinge;
  return count++;
}

double hinge_first_fracture(void) { return first_fracture; }

static double capacity(Hinge const* h, double rotation) {
  double const* c = h->capacity;
  for (int i = 1; i < h->points; i++) {
    if (rotation <= c[2 * i]) {
      double share = (rotation - c[2 * i - 2]) / (c[2 * i] - c[2 * i - 2]);
      return c[2 * i - 1] + share * (c[2 * i + 1] - c[2 * i - 1]);
    }
  }
  return c[2 * h->points - 1];
}

static double moment(Hinge const* h, int k, double rotation, double* plastic, double* largest) {
  *plastic = h->plastic[k];
  *largest = fmax(h->largest[k], fabs(rotation));
  double limit = capacity(h, *largest);
  double m = h->stiffness * (rotation - *plastic);
  if (m > limit) {
    m = limit;
    *plastic = rotation - m / h->stiffness;
  } else if (m < -limit) {
    m = -limit;
    *plastic = rotation - m / h->stiffness;
  }
  return m;
}

static void turn_of(Hinge const* h, mjData const* d, int side, mjtNum q[4]) {
  if (h->q[side] < 0) {
    mju_unit4(q);
  } else {
    mju_copy4(q, d->qpos + h->q[side] + 3);
    mju_normalize4(q);
  }
}

static void rotation_of(Hinge const* h, mjData const* d, mjtNum qa[4], mjtNum qb[4], mjtNum r[3]) {
  if (h->turns) {
    mju_unit4(qa);
    mju_scl3(r, h->axis, d->qpos[h->q[1]]);
    return;
  }
  mjtNum inverse[4], own[4], back[4];
  turn_of(h, d, 0, qa);
  turn_of(h, d, 1, qb);
  mju_negQuat(inverse, qa);
  mju_mulQuat(own, inverse, qb);
  mju_negQuat(inverse, h->start);
  mju_mulQuat(back, own, inverse);
  mju_quat2Vel(r, back, 1);
}

static void passive(mjModel const* m, mjData* d) {
  for (int i = 0; i < count; i++) {
    Hinge const* h = hinges + i;
    if (h->broken) continue;
    mjtNum qa[4], qb[4], r[3], local[3], torque[3], inverse[4], on[3];
    double plastic, largest;
    rotation_of(h, d, qa, qb, r);
    for (int k = 0; k < 3; k++) local[k] = moment(h, k, r[k], &plastic, &largest);
    if (h->turns) {
      d->qfrc_passive[h->v[1]] -= mju_dot3(local, h->axis);
      continue;
    }
    /* torques of a free joint count in the frame of its body; the first body's frame is that of the moments */
    if (h->q[0] >= 0) mju_addTo3(d->qfrc_passive + h->v[0] + 3, local);
    mju_rotVecQuat(torque, local, qa);
    mju_negQuat(inverse, qb);
    mju_rotVecQuat(on, torque, inverse);
    mju_subFrom3(d->qfrc_passive + h->v[1] + 3, on);
  }
}

/* Takes the state at the end of a step into the history; opens what is broken. */
static void commit(mjData* d) {
  for (int i = 0; i < count; i++) {
    Hinge* h = hinges + i;
    if (h->broken) continue;
    mjtNum qa[4], qb[4], r[3];
    rotation_of(h, d, qa, qb, r);
    for (int k = 0; k < 3; k++) {
      double plastic, largest;
      moment(h, k, r[k], &plastic, &largest);
      h->plastic[k] = plastic;
      h->largest[k] = largest;
    }
    if (h->fracture > 0 && mju_norm3(r) > h->fracture) {
      h->broken = 1;
      if (first_fracture < 0) first_fracture = d->time;
      if (h->equality >= 0) d->eq_active[h->equality] = 0;
    }
  }
}

void hinge_run(mjModel const* m, mjData* d, int steps) {
  mjcb_passive = passive;
  for (int i = 0; i < steps; i++) {
    mj_step(m, d);
    commit(d);
  }
  mjcb_passive = 0;
}

/* Elastic energy and the history's state for the energy balance [J]. */
double hinge_elastic(mjData const* d) {
  double energy = 0;
  for (int i = 0; i < count; i++) {
    Hinge const* h = hinges + i;
    if (h->broken) continue;
    mjtNum qa[4], qb[4], r[3];
    rotation_of(h, d, qa, qb, r);
    for (int k = 0; k < 3; k++) {
      double plastic, largest;
      double m = moment(h, k, r[k], &plastic, &largest);
      energy += 0.5 * m * m / h->stiffness;
    }
  }
  return energy;
}
