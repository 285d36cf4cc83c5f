/* SPDX-License-Identifier: MIT */
/* Controllers that coopdyn loads at run time: one shared object NAME.so that exports
 * coopdyn_controller_entry(), in C or any language with C functions. A scenario names it: `controller NAME
 * option=value` for a robot, or `supervisor NAME option=value` in [SIMULATION] for the world.
 * `coopdyn new-controller NAME` writes a starting point.
 *
 * Controllers run in a child process of the daemon, so a failure stops only one robot or the supervisor.
 * Several threads may step controllers of different robots at the same time, but never one instance: keep
 * mutable state in the instance, not in globals. For repeatable runs use the given seed, never clock() or
 * rand(). Units are SI; headings and bearings are 0 ahead and positive to the left, in (-pi, pi]. */
#ifndef COOPDYN_CONTROLLER_H
#define COOPDYN_CONTROLLER_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The version of this file. The daemon refuses a controller built against another version. */
#define COOPDYN_CONTROLLER_VERSION 5

#define COOPDYN_MAX_MESSAGE 8           /* numbers in one broadcast */
#define COOPDYN_MAX_OPTIONS 64          /* per controller */
#define COOPDYN_MAX_STATE 65536         /* bytes */
#define COOPDYN_MAX_NAME 64             /* bytes of a name, including the final 0 */
#define COOPDYN_MAX_TEXT 128            /* bytes of a text, including the final 0 */
#define COOPDYN_MAX_LOGS 16             /* numbers logged in one step */
#define COOPDYN_MAX_MOVES 4096          /* things that a supervisor moves in one step */
#define COOPDYN_ANY_OPTIONS 0xffffffffu /* as option_count: accepts any option, see coopdyn_robot.options */

/* The readings that a controller requests; all others cost nothing and are empty. COOPDYN_SETPOINTS is not a
 * reading: the controller commands each channel by a set-point, see coopdyn_command; it excludes
 * COOPDYN_MAPPED. COOPDYN_WORLD alone makes the controller a supervisor. */
enum coopdyn_reading {
  COOPDYN_DISTANCES = 1,
  COOPDYN_POSE = 2, /* ground truth */
  COOPDYN_CHANNELS = 4,
  COOPDYN_TARGETS = 8,
  COOPDYN_NEIGHBOURS = 16,
  COOPDYN_MESSAGES = 32,
  COOPDYN_COMPASS = 64,
  COOPDYN_SETPOINTS = 128,
  COOPDYN_SUPPORT = 256,  /* of the load that the robot carries */
  COOPDYN_MOTION = 512,   /* ground truth: orientation and velocities of the body */
  COOPDYN_SENSORS = 1024, /* the modules that coopdyn_description.sensors names: lidar, imu, camera, ... */
  COOPDYN_WORLD = 2048,   /* for a supervisor: everything in the world, and the scores */
  /* The robot's module `channel`: all motors and values in one exchange, mapped as the experiment defines.
   * Then step() is called once per exchange, and coopdyn_command.motors drives the robot. */
  COOPDYN_MAPPED = 4096
};

/* An option of the controller line in a scenario. */
typedef struct coopdyn_option {
  const char* name; /* [a-z][a-z0-9_]* */
  const char* help; /* one line, with the unit */
  double value;     /* default */
  double min, max;
} coopdyn_option;

typedef struct coopdyn_description {
  const char* help;      /* one line */
  uint32_t readings;     /* sum of enum coopdyn_reading */
  uint32_t state_size;   /* bytes that save() writes: all that step() changes; at most COOPDYN_MAX_STATE */
  uint32_t option_count; /* at most COOPDYN_MAX_OPTIONS; or COOPDYN_ANY_OPTIONS without options */
  const coopdyn_option* options;
  /* Only with COOPDYN_SENSORS: names or types of sensor modules, separated by blanks, e.g. "lidar imu". NULL:
   * all but cameras, whose pictures are drawn only for controllers that name them. */
#ifdef __cplusplus
  const char* sensors = nullptr; /* initialisers may omit it */
#else
  const char* sensors;
#endif
} coopdyn_description;

/* The mode of a channel. A wheel supports off and velocity; coopdyn_joint.modes lists those of a channel. */
enum coopdyn_mode {
  COOPDYN_OFF = 0,      /* stands still; ignores the reference */
  COOPDYN_POSITION = 1, /* rad or m: moves there within the profile's speed and acceleration */
  COOPDYN_DIRECT = 2,   /* rad or m: reaches it at the end of this step */
  COOPDYN_VELOCITY = 3, /* rad/s or m/s */
  COOPDYN_EFFORT = 4,   /* N m or N */
  COOPDYN_PWM = 5       /* drive train: duty of its motor, -1 to 1, 0 brakes; muscle: activation, 0 to 1 */
};

/* A channel: a joint axis, such as a wheel, that a module drives. */
typedef struct coopdyn_joint {
  const char* module;  /* its name, e.g. motors; "": no module, stays at rest */
  const char* name;    /* joint name */
  uint32_t modes;      /* supported modes: sum of 1 << mode; always includes COOPDYN_OFF */
  double max_velocity; /* rad/s or m/s; inf: no known limit */
  uint32_t slides;     /* 0: turns; rad, N m. 1: slides along its axis; m, N */
  double lower, upper; /* stops; inf: none */
  double max_effort;   /* N m or N */
  double point_m[3];   /* a point on its axis, in the robot's frame with all joints at 0 */
  double axis[3];      /* direction of its axis, length 1, in the same frame */
} coopdyn_joint;

/* A sensor module whose readings the controller requests. */
typedef struct coopdyn_sensor {
  const char* module;     /* its name, e.g. front_lidar */
  const char* type;       /* e.g. lidar */
  size_t value_count;     /* values of a reading, in the order and units of the module's first get command;
                             contact sensor: the zones of get_bumper; camera: 0 */
  uint32_t width, height; /* of a camera's picture */
} coopdyn_sensor;

/* A motor or a value of a robot's channel. Internal values have SI units, or those of a module's reading;
 * external values are exchanged. inf: has no range and is not mapped. */
typedef struct coopdyn_mapped {
  const char* name; /* neighbours of the same name form one sensor of several values */
  double internal_min, internal_max;
  double external_min, external_max; /* for internal_min and internal_max; may be decreasing */
  uint32_t auxiliary;                /* 1: for the experimenter, not for the controller */
} coopdyn_mapped;

/* An option set in the scenario. */
typedef struct coopdyn_given {
  const char* name;
  double value;
} coopdyn_given;

/* The robot that a controller drives. Valid until destroy(). For a supervisor all fields are 0 and the name
 * is "". */
typedef struct coopdyn_robot {
  uint32_t id;
  const char* name;
  double radius_m;                                       /* of its footprint */
  double wheel_radius_m, track_m, max_wheel_speed_rad_s; /* all 0: no two-wheel drive */
  size_t channel_count;
  const coopdyn_joint* channels;
  size_t distance_count;              /* sensors, right to left */
  const double* distance_bearing_rad; /* of the middle of each sector */
  const double* distance_opening_rad; /* of each whole sector */
  const double* distance_max_m;
  size_t sensor_count; /* COOPDYN_SENSORS: the requested sensors that the robot has */
  const coopdyn_sensor* sensors;
  size_t motor_count; /* COOPDYN_MAPPED: motors of its channel */
  const coopdyn_mapped* motors;
  size_t mapped_count; /* COOPDYN_MAPPED: values of its channel */
  const coopdyn_mapped* mapped;
  double exchange_s;   /* time between two calls of step() */
  size_t option_count; /* COOPDYN_ANY_OPTIONS: the options set in the scenario, in its order */
  const coopdyn_given* options;
} coopdyn_robot;

/* Another robot, as seen from this one's origin. */
typedef struct coopdyn_sighting {
  uint32_t id;
  double distance_m, bearing_rad;
} coopdyn_sighting;

/* A target, as seen from the robot's origin. Colours are from 0 to 1. */
typedef struct coopdyn_target {
  uint32_t id;
  double distance_m, bearing_rad;
  double red, green, blue;
} coopdyn_target;

/* A broadcast of another robot, and where that robot is now. */
typedef struct coopdyn_heard {
  coopdyn_sighting from;
  uint32_t count;
  double values[COOPDYN_MAX_MESSAGE];
} coopdyn_heard;

/* The state of a channel: rad, rad/s and N m; for a sliding joint m, m/s and N. */
typedef struct coopdyn_channel {
  double position; /* since the start of the run, not wrapped */
  double velocity; /* mean over the last step */
  double effort;   /* of its motor; nan: not measured */
} coopdyn_channel;

/* A sensor's current sample. */
typedef struct coopdyn_sensor_reading {
  uint64_t step;        /* step of the sample */
  const double* values; /* value_count values */
  const uint8_t* image; /* of a camera: width x height x 3 bytes red green blue, row by row from the top */
} coopdyn_sensor_reading;

/* A pose: the frame's origin, and its orientation as a quaternion w x y z. */
typedef struct coopdyn_pose {
  double p_m[3];
  double q[4];
} coopdyn_pose;

enum coopdyn_kind { COOPDYN_THING = 0, COOPDYN_ROBOT = 1, COOPDYN_TARGET = 2, COOPDYN_LIGHT = 3 };

/* A thing, robot, target or light in the world. Targets and lights have only a position. */
typedef struct coopdyn_body {
  uint32_t id;                 /* as in /world; constant during the body's lifetime */
  uint32_t kind;               /* of enum coopdyn_kind */
  char name[COOPDYN_MAX_NAME]; /* e.g. robot1, BOX_1, red_target_1, LIGHT_1 */
  coopdyn_pose pose;           /* of its frame in the world */
  double velocity_m_s[3];      /* of its origin, along the world's axes */
  double angular_velocity_rad_s[3];
} coopdyn_body;

/* A [SCORE_n] of the scenario. */
typedef struct coopdyn_score {
  char name[COOPDYN_MAX_NAME];
  double value; /* nan: undefined */
  uint32_t met; /* 1: its `until` holds */
} coopdyn_score;

/* The world before a step, for a supervisor: ground truth. */
typedef struct coopdyn_world {
  size_t body_count;
  const coopdyn_body* bodies; /* things, robots, targets, lights; each kind sorted by id */
  size_t score_count;
  const coopdyn_score* scores; /* in the scenario's order */
} coopdyn_world;

/* The robot's readings before a step. Valid only during step(). */
typedef struct coopdyn_readings {
  uint64_t seed; /* of the run */
  uint64_t step; /* of these readings: 0, 1, ... */
  double time_s, step_s;
  size_t distance_count; /* metres from the chassis, inf = nothing there */
  const double* distance_m;
  double x_m, y_m, heading_rad, forward_m_s, turn_rad_s; /* COOPDYN_POSE */
  size_t channel_count;                                  /* COOPDYN_CHANNELS */
  const coopdyn_channel* channels;                       /* in the order of coopdyn_robot.channels */
  size_t target_count;
  const coopdyn_target* targets;
  size_t neighbour_count;
  const coopdyn_sighting* neighbours;
  size_t heard_count;
  const coopdyn_heard* heard;
  double compass_rad; /* COOPDYN_COMPASS: heading in the world; nan: the robot has no compass */
  /* COOPDYN_SUPPORT: as in get_support; nan: the robot has no support. */
  double support_x_m, support_y_m, support_rad;
  /* COOPDYN_MOTION, in addition to heading_rad: motion of the robot's frame R in the world. */
  double height_m;            /* of its origin: 0 while it stands on the floor as at the start */
  double roll_rad, pitch_rad; /* about its x, then y axis; pitch is positive if the front is down */
  double velocity_m_s[3];     /* of its origin, along its axes: forward, left, up */
  double angular_velocity_rad_s[3];
  const coopdyn_sensor_reading* sensors; /* COOPDYN_SENSORS: one per coopdyn_robot.sensors */
  const coopdyn_world* world;            /* COOPDYN_WORLD; else NULL */
  const double* mapped;                  /* COOPDYN_MAPPED: mapped_count external values; nan: unknown */
} coopdyn_readings;

/* The command of one channel. If a wheel of a two-wheel drive would be too fast, both are scaled by the same
 * factor. */
typedef struct coopdyn_setpoint {
  uint32_t mode; /* of enum coopdyn_mode; the channel must support it */
  double reference;
} coopdyn_setpoint;

/* A logged number: appears in the status, on the page, in the recording and in its exports. */
typedef struct coopdyn_logged {
  char name[COOPDYN_MAX_NAME]; /* a letter, then letters, digits and _; a controller of robot1 logs it as
                                  robot1.NAME */
  double value;
} coopdyn_logged;

/* Moves a body for a supervisor; the body is at rest afterwards. */
typedef struct coopdyn_move {
  uint32_t id; /* of a coopdyn_body */
  coopdyn_pose pose;
} coopdyn_move;

/* The actions of a supervisor. All moves of a step are made together at its end, or none if one is impossible
 * (two things would overlap). Then the run ends, if requested. */
typedef struct coopdyn_supervision {
  size_t move_count;
  coopdyn_move* moves; /* room for COOPDYN_MAX_MOVES */
  uint32_t end_run;    /* 1: end the run after this step */
  char why[COOPDYN_MAX_TEXT];
} coopdyn_supervision;

/* The robot's command for the step. All zero when step() is called: the robot stands and is silent. Write
 * through the pointers, but do not change them. */
typedef struct coopdyn_command {
  double forward_m_s, turn_rad_s; /* of a two-wheel drive; beyond the wheels' limit both are scaled alike */
  coopdyn_setpoint* setpoints;    /* one per channel, instead of forward and turn; NULL if describe() does not
                                     request COOPDYN_SETPOINTS */
  uint32_t message_count;         /* numbers to broadcast; 0: nothing */
  double message[COOPDYN_MAX_MESSAGE];
  uint32_t log_count;               /* numbers to log */
  coopdyn_logged* logs;             /* room for COOPDYN_MAX_LOGS; coopdyn_log() adds one */
  coopdyn_supervision* supervision; /* for a supervisor; else NULL */
  /* COOPDYN_MAPPED: external values, one per motor, instead of forward, turn and set-points. Values are
   * clamped to the range and hold until the next exchange. Else NULL. */
  double* motors;
  uint32_t end_run; /* for a robot's controller; 1: end the run after this step */
} coopdyn_command;

/* Copies a text into a field of `size` bytes, truncated if it does not fit. */
static inline void coopdyn_copy(char* to, const char* text, size_t size) {
  size_t i = 0;
  for (; i + 1 < size && text[i] != '\0'; ++i) to[i] = text[i];
  to[i] = '\0';
}

/* Logs a number, e.g. coopdyn_log(command, "energy", 3.5). */
static inline void coopdyn_log(coopdyn_command* command, const char* name, double value) {
  const uint32_t place = command->log_count++;
  if (place >= COOPDYN_MAX_LOGS) return; /* too many: the daemon says so */
  coopdyn_copy(command->logs[place].name, name, COOPDYN_MAX_NAME);
  command->logs[place].value = value;
}

/* The body called `name`; NULL if there is none. */
static inline const coopdyn_body* coopdyn_find(const coopdyn_world* world, const char* name) {
  for (size_t i = 0; i < world->body_count; ++i) {
    const char* other = world->bodies[i].name;
    size_t k = 0;
    while (name[k] != '\0' && name[k] == other[k]) ++k;
    if (name[k] == other[k]) return &world->bodies[i];
  }
  return NULL; /* NOLINT(modernize-use-nullptr): C has no other */
}

/* For a supervisor: moves the body with this id to a pose. */
static inline void coopdyn_put(coopdyn_command* command, uint32_t id, coopdyn_pose pose) {
  coopdyn_supervision* doing = command->supervision;
  const size_t place = doing->move_count++;
  if (place >= COOPDYN_MAX_MOVES) return; /* too many: the daemon says so */
  doing->moves[place].id = id;
  doing->moves[place].pose = pose;
}

/* For a supervisor: ends the run. */
static inline void coopdyn_end_run(coopdyn_command* command, const char* why) {
  command->supervision->end_run = 1;
  coopdyn_copy(command->supervision->why, why, COOPDYN_MAX_TEXT);
}

/* The functions of a controller. Only save() and restore() may be NULL, if state_size is 0. The order of
 * calls is create, reset, [restore,] { step, save }, destroy. An escaped C++ exception stops the robot, with
 * its text as the reason. */
typedef struct coopdyn_controller {
  uint32_t version; /* COOPDYN_CONTROLLER_VERSION; always the first field */
  /* Returns a constant description, valid until the process ends. */
  const coopdyn_description* (*describe)(void);
  /* Returns a new instance; `options` has one value per described option (COOPDYN_ANY_OPTIONS: per given
   * option). Returns NULL if the controller cannot drive this robot, with the reason in `error` (at most
   * `error_size` bytes, including the final 0). */
  void* (*create)(const coopdyn_robot* robot, const double* options, char* error, size_t error_size);
  /* Prepares for the start of a run. Called once before the first step(). */
  void (*reset)(void* instance, uint64_t seed);
  void (*step)(void* instance, const coopdyn_readings* readings, coopdyn_command* command);
  /* Writes state_size bytes after every step. After restore() the next steps must be the same, even in
   * another process: write no pointers. */
  void (*save)(const void* instance, void* state);
  void (*restore)(void* instance, const void* state);
  void (*destroy)(void* instance);
} coopdyn_controller;

/* These return the same bits on every machine, within 1 ulp; angles in rad. libm's functions do not, because
 * libm selects code by processor. sqrt, floor, fmod and remainder are exact everywhere. */
double coopdyn_sin(double x);
double coopdyn_cos(double x);
double coopdyn_tan(double x);
double coopdyn_asin(double x);
double coopdyn_acos(double x);
double coopdyn_atan(double x);
double coopdyn_exp(double x);
double coopdyn_ln(double x);
double coopdyn_cbrt(double x);
double coopdyn_sinh(double x);
double coopdyn_cosh(double x);
double coopdyn_tanh(double x);
double coopdyn_exp2(double x);
double coopdyn_exp10(double x);
double coopdyn_expm1(double x);
double coopdyn_log2(double x);
double coopdyn_log10(double x);
double coopdyn_log1p(double x);
double coopdyn_atan2(double y, double x);
double coopdyn_pow(double x, double y);
double coopdyn_hypot(double x, double y);
void coopdyn_sincos(double x, double* sine, double* cosine);

#if defined(__GNUC__)
#define COOPDYN_EXPORT __attribute__((visibility("default")))
#else
#define COOPDYN_EXPORT
#endif

/* The function that the shared object exports under this name. */
COOPDYN_EXPORT const coopdyn_controller* coopdyn_controller_entry(void);
#define COOPDYN_CONTROLLER_ENTRY "coopdyn_controller_entry"

#ifdef __cplusplus
}
#endif

#endif
