/* @NAME@: a supervisor, which controls the world instead of a robot. It puts the ball back when it leaves the
 * field, logs how often, and ends the run. Change step(); controller.h documents the interface. README.md
 * beside this file says how to try it. */
#include "controller.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* Options of the scenario's line, e.g. `supervisor @NAME@ field=1.5`: name, help, default, min, max. */
static const coopdyn_option options[] = {
    {"field", "half its length, m", 1.5, 0.1, 100},
    {"outs", "after this many the run ends", 3, 1, 1e6},
};

/* Everything that step() changes. It is saved after each step, so that a run can continue from it. */
typedef struct {
  coopdyn_pose start; /* of the ball */
  uint32_t outs;
} state_t;

typedef struct {
  double field_m, most_outs;
  state_t state;
} instance_t;

static const coopdyn_description* describe(void) {
  static const coopdyn_description description = {
      "puts the ball back when it has left the field", /* help */
      COOPDYN_WORLD,                                   /* alone: makes this a supervisor */
      sizeof(state_t),
      sizeof(options) / sizeof(options[0]),
      options,
      NULL,
  };
  return &description;
}

static void* create(const coopdyn_robot* none, const double* values, char* error, size_t error_size) {
  instance_t* me = calloc(1, sizeof(*me));
  (void)none;
  if (me == NULL) {
    snprintf(error, error_size, "out of memory");
    return NULL;
  }
  me->field_m = values[0];
  me->most_outs = values[1];
  return me;
}

static void reset(void* instance, uint64_t seed) {
  instance_t* me = instance;
  (void)seed; /* seed your random numbers with it */
  me->state.outs = 0;
}

static void step(void* instance, const coopdyn_readings* readings, coopdyn_command* command) {
  instance_t* me = instance;
  const coopdyn_body* ball = coopdyn_find(readings->world, "BALL_1");
  if (ball == NULL) {
    coopdyn_end_run(command, "there is no BALL_1");
    return;
  }
  if (readings->step == 0) me->state.start = ball->pose;
  if (fabs(ball->pose.p_m[0]) < me->field_m && fabs(ball->pose.p_m[1]) < me->field_m) return;
  me->state.outs += 1;
  coopdyn_log(command, "outs", me->state.outs);
  coopdyn_put(command, ball->id, me->state.start); /* moves after this step and is then at rest */
  if (me->state.outs >= me->most_outs) coopdyn_end_run(command, "the ball was out too often");
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
