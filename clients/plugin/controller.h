/* SPDX-License-Identifier: MIT */
/* Controllers that coopdyn loads at run time: one shared object NAME.so that exports
 * coopdyn_controller_entry(), in C or any language with C functions. A scenario names it: `controller NAME
 * option=value` of a robot, or `supervisor NAME option=value` of [SIMULATION], which is the world's.
 * `coopdyn new-controller NAME` writes a start.
 *
 * Where it runs: in a child process of the daemon, so that whatever goes wrong stops one robot, or the
 * supervisor, and nothing else. Controllers of different robots may be stepped at the same time by different
 * threads, one instance never by two: keep what changes in the instance, not in globals. To be repeatable use
 * the seed given, never clock() or rand(). Units are SI; headings and bearings 0 ahead, left positive, in
 * (-pi, pi]. */
#ifndef COOPDYN_CONTROLLER_H
#define COOPDYN_CONTROLLER_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Of this file. A controller built against another one is refused. */
#define COOPDYN_CONTROLLER_VERSION 5

#define COOPDYN_MAX_MESSAGE 8           /* numbers in one broadcast */
#define COOPDYN_MAX_OPTIONS 64          /* of one controller */
#define COOPDYN_MAX_STATE 65536         /* bytes */
#define COOPDYN_MAX_NAME 64             /* bytes of a name, the final 0 included */
#define COOPDYN_MAX_TEXT 128            /* bytes of a text, likewise */
#define COOPDYN_MAX_LOGS 16             /* numbers logged in one step */
#define COOPDYN_MAX_MOVES 4096          /* things that a supervisor moves in one step */
#define COOPDYN_ANY_OPTIONS 0xffffffffu /* as option_count: takes any, see coopdyn_robot.options */

/* Which readings a controller wants: the others cost nothing and are empty. COOPDYN_SETPOINTS is none: it
 * says that the controller commands each channel by a set-point, see coopdyn_command; COOPDYN_MAPPED does not
 * go with it. COOPDYN_WORLD, without any other, says that the controller is a supervisor. */
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
  COOPDYN_MOTION = 512,   /* ground truth: how the body lies and moves */
  COOPDYN_SENSORS = 1024, /* the modules that coopdyn_description.sensors names: lidar, imu, camera, ... */
  COOPDYN_WORLD = 2048,   /* of a supervisor: all that stands in the world, and the scores */
  /* The robot's module `channel`: all motors and values in one exchange, mapped as its experiment says. Then
   * step() is called once for each exchange, and coopdyn_command.motors drives the robot. */
  COOPDYN_MAPPED = 4096
};

/* An option of a scenario's controller line. */
typedef struct coopdyn_option {
  const char* name; /* [a-z][a-z0-9_]* */
  const char* help; /* one line, with the unit */
  double value;     /* if the line does not give it */
  double min, max;
} coopdyn_option;

typedef struct coopdyn_description {
  const char* help;      /* one line */
  uint32_t readings;     /* of enum coopdyn_reading, added up */
  uint32_t state_size;   /* bytes that save() writes: all that step() changes; at most COOPDYN_MAX_STATE */
  uint32_t option_count; /* at most COOPDYN_MAX_OPTIONS; or COOPDYN_ANY_OPTIONS, and no options */
  const coopdyn_option* options;
  /* Only with COOPDYN_SENSORS: names or types of sensor modules, separated by blanks, e.g. "lidar imu". NULL:
   * all but cameras, whose pictures are drawn only for controllers that name them. */
#ifdef __cplusplus
  const char* sensors = nullptr; /* so that an initialiser may leave it out */
#else
  const char* sensors;
#endif
} coopdyn_description;

/* What a channel does. A wheel takes off and velocity; a joint of a control board takes all. */
enum coopdyn_mode {
  COOPDYN_OFF = 0,      /* it stands still; the reference means nothing */
  COOPDYN_POSITION = 1, /* rad or m: goes there within the profile's speed and acceleration */
  COOPDYN_DIRECT = 2,   /* rad or m: is there at the end of this step */
  COOPDYN_VELOCITY = 3, /* rad/s or m/s */
  COOPDYN_EFFORT = 4,   /* N m or N */
  COOPDYN_PWM = 5 /* a drive train: its motor's duty, -1 to 1, 0 brakes; a muscle: its activation, 0 to 1 */
};

/* A channel: a joint axis that a module drives. A wheel is one. */
typedef struct coopdyn_joint {
  const char* module;  /* its name, e.g. motors; "": no module, it stays at rest */
  const char* name;    /* of the joint */
  uint32_t modes;      /* that it takes: 1 << mode, added up; COOPDYN_OFF is always among them */
  double max_velocity; /* rad/s or m/s; inf: no limit is known */
  uint32_t slides;     /* 0: it turns; rad, N m. 1: it slides along its axis; m, N */
  double lower, upper; /* its stops; inf: none */
  double max_effort;   /* N m or N */
  double point_m[3];   /* a point of its axis, in the robot's frame with all joints at 0 */
  double axis[3];      /* its direction, of length 1, likewise */
} coopdyn_joint;

/* A sensor's module whose readings the controller wants. */
typedef struct coopdyn_sensor {
  const char* module;     /* its name, e.g. front_lidar */
  const char* type;       /* e.g. lidar */
  size_t value_count;     /* of its reading, in the order and units of its first get-command; of a contact
                             sensor the zones of get_bumper; 0: a camera */
  uint32_t width, height; /* of a camera's picture */
} coopdyn_sensor;

/* A motor or a value of a robot's channel. Internal values are SI units, or those of a module's reading;
 * external ones are what is exchanged. inf: it has no range, and is not mapped. */
typedef struct coopdyn_mapped {
  const char* name; /* neighbours that are called alike are one sensor of several values */
  double internal_min, internal_max;
  double external_min, external_max; /* of internal_min and internal_max: may fall */
  uint32_t auxiliary;                /* 1: for the experimenter, not for the controller */
} coopdyn_mapped;

/* An option that the scenario gives. */
typedef struct coopdyn_given {
  const char* name;
  double value;
} coopdyn_given;

/* The robot that a controller drives. Valid until destroy(). A supervisor has none: all is 0, the name is "".
 */
typedef struct coopdyn_robot {
  uint32_t id;
  const char* name;
  double radius_m;                                       /* of its footprint */
  double wheel_radius_m, track_m, max_wheel_speed_rad_s; /* all 0: it has no two-wheel drive */
  size_t channel_count;
  const coopdyn_joint* channels;
  size_t distance_count;              /* sensors, right to left */
  const double* distance_bearing_rad; /* of the sector's middle */
  const double* distance_opening_rad; /* of the whole sector */
  const double* distance_max_m;
  size_t sensor_count; /* COOPDYN_SENSORS: those that were asked for and that it has */
  const coopdyn_sensor* sensors;
  size_t motor_count; /* COOPDYN_MAPPED: of its channel */
  const coopdyn_mapped* motors;
  size_t mapped_count; /* likewise: the values */
  const coopdyn_mapped* mapped;
  double exchange_s;   /* from one step() to the next */
  size_t option_count; /* COOPDYN_ANY_OPTIONS: those that the scenario gives, in its order */
  const coopdyn_given* options;
} coopdyn_robot;

/* Another robot, as seen from this one's origin. */
typedef struct coopdyn_sighting {
  uint32_t id;
  double distance_m, bearing_rad;
} coopdyn_sighting;

/* A target, seen in the same way. Its colour is from 0 to 1. */
typedef struct coopdyn_target {
  uint32_t id;
  double distance_m, bearing_rad;
  double red, green, blue;
} coopdyn_target;

/* A broadcast of another robot, and where that one is now. */
typedef struct coopdyn_heard {
  coopdyn_sighting from;
  uint32_t count;
  double values[COOPDYN_MAX_MESSAGE];
} coopdyn_heard;

/* The state of a channel: rad, rad/s and N m, or of a joint that slides m, m/s and N. */
typedef struct coopdyn_channel {
  double position; /* since the start of the run, not wrapped */
  double velocity; /* mean of the last step */
  double effort;   /* of its motor; nan: not measured */
} coopdyn_channel;

/* What a sensor shows. */
typedef struct coopdyn_sensor_reading {
  uint64_t step;        /* in which the sample was taken */
  const double* values; /* value_count of them */
  const uint8_t* image; /* of a camera: width x height x 3 bytes red green blue, row by row from the top */
} coopdyn_sensor_reading;

/* A pose: the frame's origin, and its orientation as a quaternion w x y z. */
typedef struct coopdyn_pose {
  double p_m[3];
  double q[4];
} coopdyn_pose;

enum coopdyn_kind { COOPDYN_THING = 0, COOPDYN_ROBOT = 1, COOPDYN_TARGET = 2, COOPDYN_LIGHT = 3 };

/* What stands in the world. A target and a light have a place only. */
typedef struct coopdyn_body {
  uint32_t id;                 /* as /world tells it; the same as long as it is there */
  uint32_t kind;               /* of enum coopdyn_kind */
  char name[COOPDYN_MAX_NAME]; /* e.g. robot1, BOX_1, red_target_1, LIGHT_1 */
  coopdyn_pose pose;           /* of its frame in the world */
  double velocity_m_s[3];      /* of its origin, along the world's axes */
  double angular_velocity_rad_s[3];
} coopdyn_body;

/* A [SCORE_n] of the scenario. */
typedef struct coopdyn_score {
  char name[COOPDYN_MAX_NAME];
  double value; /* nan: it cannot be told */
  uint32_t met; /* 1: its `until` */
} coopdyn_score;

/* What a supervisor sees before a step: ground truth. */
typedef struct coopdyn_world {
  size_t body_count;
  const coopdyn_body* bodies; /* things, robots, targets, lights; of each kind by id */
  size_t score_count;
  const coopdyn_score* scores; /* in the scenario's order */
} coopdyn_world;

/* What the robot feels before a step. Valid during step() only. */
typedef struct coopdyn_readings {
  uint64_t seed; /* of the run */
  uint64_t step; /* of these readings: 0, 1, ... */
  double time_s, step_s;
  size_t distance_count; /* metres from the chassis, inf = nothing there */
  const double* distance_m;
  double x_m, y_m, heading_rad, forward_m_s, turn_rad_s; /* COOPDYN_POSE */
  size_t channel_count;                                  /* COOPDYN_CHANNELS */
  const coopdyn_channel* channels;                       /* in the order of the robot's */
  size_t target_count;
  const coopdyn_target* targets;
  size_t neighbour_count;
  const coopdyn_sighting* neighbours;
  size_t heard_count;
  const coopdyn_heard* heard;
  double compass_rad; /* COOPDYN_COMPASS: heading in the world; nan: the robot has no compass */
  /* COOPDYN_SUPPORT: as get_support; nan: the robot has no support. */
  double support_x_m, support_y_m, support_rad;
  /* COOPDYN_MOTION, besides heading_rad: of the robot's frame R in the world. */
  double height_m;            /* of its origin: 0 as long as it stands on the floor as at the start */
  double roll_rad, pitch_rad; /* about its x, then y axis; pitch is positive if the front is down */
  double velocity_m_s[3];     /* of its origin, along its axes: forward, left, up */
  double angular_velocity_rad_s[3];
  const coopdyn_sensor_reading* sensors; /* COOPDYN_SENSORS: one for each of the robot's sensors */
  const coopdyn_world* world;            /* COOPDYN_WORLD; NULL without */
  const double* mapped; /* COOPDYN_MAPPED: the robot's mapped_count external values; nan: it cannot be told */
} coopdyn_readings;

/* What one channel is to do. A two-wheel drive whose wheels would be too fast scales both alike. */
typedef struct coopdyn_setpoint {
  uint32_t mode; /* of enum coopdyn_mode, one that the channel takes */
  double reference;
} coopdyn_setpoint;

/* A number that is logged: it goes to the status, the page, the recording and what is exported of it. */
typedef struct coopdyn_logged {
  char name[COOPDYN_MAX_NAME]; /* a letter, then letters, digits and _; of robot1's controller the log is
                                  called robot1.NAME */
  double value;
} coopdyn_logged;

/* Where a supervisor puts something: it comes to rest there. */
typedef struct coopdyn_move {
  uint32_t id; /* of a coopdyn_body */
  coopdyn_pose pose;
} coopdyn_move;

/* What a supervisor does. All moves of a step are made at its end, together or, if one of them cannot be
 * (two things would overlap), none. Then the run ends, if it is to. */
typedef struct coopdyn_supervision {
  size_t move_count;
  coopdyn_move* moves; /* room for COOPDYN_MAX_MOVES */
  uint32_t end_run;    /* 1: the run ends after this step */
  char why[COOPDYN_MAX_TEXT];
} coopdyn_supervision;

/* What the robot does in the step. All zero when step() is called: it stands and is silent. Write through the
 * pointers, leave them as they are. */
typedef struct coopdyn_command {
  double forward_m_s, turn_rad_s; /* of a two-wheel drive; beyond the wheels' limit both are scaled alike */
  coopdyn_setpoint* setpoints; /* one for each channel, instead of forward and turn; NULL if describe() does
                                  not ask for COOPDYN_SETPOINTS */
  uint32_t message_count;      /* numbers to broadcast; 0: nothing */
  double message[COOPDYN_MAX_MESSAGE];
  uint32_t log_count;               /* numbers that are logged */
  coopdyn_logged* logs;             /* room for COOPDYN_MAX_LOGS; coopdyn_log() adds one */
  coopdyn_supervision* supervision; /* of a supervisor; else NULL */
  /* COOPDYN_MAPPED: external values, one for each of the robot's motors, instead of forward, turn and
   * set-points. What is beyond the range is cut. They stay until the next exchange. Else NULL. */
  double* motors;
  uint32_t end_run; /* of a robot's controller: 1: the run ends after this step */
} coopdyn_command;

/* The text in a field of `size` bytes; what does not fit is left out. */
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

/* What is called `name`; NULL: it is not there. */
static inline const coopdyn_body* coopdyn_find(const coopdyn_world* world, const char* name) {
  for (size_t i = 0; i < world->body_count; ++i) {
    const char* other = world->bodies[i].name;
    size_t k = 0;
    while (name[k] != '\0' && name[k] == other[k]) ++k;
    if (name[k] == other[k]) return &world->bodies[i];
  }
  return NULL; /* NOLINT(modernize-use-nullptr): C has no other */
}

/* A supervisor puts what has this id to a pose. */
static inline void coopdyn_put(coopdyn_command* command, uint32_t id, coopdyn_pose pose) {
  coopdyn_supervision* doing = command->supervision;
  const size_t place = doing->move_count++;
  if (place >= COOPDYN_MAX_MOVES) return; /* too many: the daemon says so */
  doing->moves[place].id = id;
  doing->moves[place].pose = pose;
}

/* A supervisor ends the run. */
static inline void coopdyn_end_run(coopdyn_command* command, const char* why) {
  command->supervision->end_run = 1;
  coopdyn_copy(command->supervision->why, why, COOPDYN_MAX_TEXT);
}

/* What a controller is made of. Only save() and restore() may be NULL, if state_size is 0. The order of calls
 * is create, reset, [restore,] { step, save }, destroy. C++ exceptions that escape stop the robot, with their
 * text. */
typedef struct coopdyn_controller {
  uint32_t version; /* COOPDYN_CONTROLLER_VERSION; always the first field */
  /* Constant, and valid until the process ends. */
  const coopdyn_description* (*describe)(void);
  /* A new instance; `options` holds one value for each described option (of COOPDYN_ANY_OPTIONS: each given).
   * NULL: it cannot drive this robot, and `error` (a text of at most `error_size` bytes, the final 0
   * included) says why. */
  void* (*create)(const coopdyn_robot* robot, const double* options, char* error, size_t error_size);
  /* Back to the start of a run. Called once before the first step(). */
  void (*reset)(void* instance, uint64_t seed);
  void (*step)(void* instance, const coopdyn_readings* readings, coopdyn_command* command);
  /* Writes state_size bytes, after every step. What restore() reads makes the next steps the same, in another
   * process too: no pointers. */
  void (*save)(const void* instance, void* state);
  void (*restore)(void* instance, const void* state);
  void (*destroy)(void* instance);
} coopdyn_controller;

/* The same bits on every machine, within 1 ulp; angles in rad. libm's functions are not: it chooses them by
 * the processor. sqrt, floor, fmod and remainder are exact everywhere. */
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

/* What the shared object exports, under this name. */
COOPDYN_EXPORT const coopdyn_controller* coopdyn_controller_entry(void);
#define COOPDYN_CONTROLLER_ENTRY "coopdyn_controller_entry"

#ifdef __cplusplus
}
#endif

#endif
