/* @NAME@: drives in curves and turns away from near things. Change step(); controller.h documents the
 * interface. README.md beside this file says how to try it. */
#include "controller.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* Options of the scenario's line, e.g. `controller @NAME@ speed=0.3`: name, help, default, min, max. */
static const coopdyn_option options[] = {
    {"speed", "of driving, m/s", 0.2, 0, 5},
    {"near", "turns away from what is nearer, m", 0.4, 0, 100},
};

/* Everything that step() changes. It is saved after each step, so that a run can continue from it. */
typedef struct {
  uint64_t turns; /* steps spent turning */
} state_t;

typedef struct {
  const coopdyn_robot* robot; /* valid until destroy() */
  double speed_m_s, near_m;
  state_t state;
} instance_t;

static const coopdyn_description* describe(void) {
  static const coopdyn_description description = {
      "drives on in curves and turns away from what is near", /* help */
      COOPDYN_DISTANCES,                                      /* requested readings, joined by | */
      sizeof(state_t),
      sizeof(options) / sizeof(options[0]),
      options,
      NULL, /* with COOPDYN_SENSORS: sensor modules, e.g. "lidar imu" */
  };
  return &description;
}

static void* create(const coopdyn_robot* robot, const double* values, char* error, size_t error_size) {
  instance_t* me;
  if (robot->distance_count == 0) {
    snprintf(error, error_size, "it needs distance sensors");
    return NULL;
  }
  me = calloc(1, sizeof(*me));
  if (me == NULL) {
    snprintf(error, error_size, "out of memory");
    return NULL;
  }
  me->robot = robot;
  me->speed_m_s = values[0];
  me->near_m = values[1];
  return me;
}

static void reset(void* instance, uint64_t seed) {
  instance_t* me = instance;
  (void)seed; /* seed your random numbers with it */
  me->state.turns = 0;
}

static void step(void* instance, const coopdyn_readings* readings, coopdyn_command* command) {
  instance_t* me = instance;
  double nearest_m = INFINITY, side_rad = 0;
  size_t i;
  for (i = 0; i < readings->distance_count; ++i) {
    if (fabs(me->robot->distance_bearing_rad[i]) > 1.2 || readings->distance_m[i] >= nearest_m) continue;
    nearest_m = readings->distance_m[i];
    side_rad = me->robot->distance_bearing_rad[i];
  }
  if (nearest_m < me->near_m) {
    command->turn_rad_s = side_rad > 0 ? -1.5 : 1.5; /* in place; left is positive */
    me->state.turns += 1;
  } else {
    command->forward_m_s = me->speed_m_s;
    command->turn_rad_s = 0.3 * coopdyn_sin(0.5 * readings->time_s);
  }
}

static void save(const void* instance, void* state) {
  *(state_t*)state = ((const instance_t*)instance)->state;
}

static void restore(void* instance, const void* state) {
  ((instance_t*)instance)->state = *(const state_t*)state;
}

static void destroy(void* instance) {
  free(instance);
}

const coopdyn_controller* coopdyn_controller_entry(void) {
  static const coopdyn_controller controller = {
      COOPDYN_CONTROLLER_VERSION, describe, create, reset, step, save, restore, destroy,
  };
  return &controller;
}
