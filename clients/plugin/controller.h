/* SPDX-License-Identifier: MIT */
/* Controllers that coopdyn loads at run time: one shared object NAME.so that exports
 * coopdyn_controller_entry(), in C or any language with C functions. A scenario names it (`controller NAME
 * option=value`); `coopdyn new-controller NAME` writes a start.
 *
 * Where it runs: in a child process of the daemon, so that whatever goes wrong stops one robot and nothing
 * else. Controllers of different robots may be stepped at the same time by different threads, one instance
 * never by two: keep what changes in the instance, not in globals. To be repeatable use the seed given, never
 * clock() or rand(). Units are SI; headings and bearings 0 ahead, left positive, in (-pi, pi]. */
#ifndef COOPDYN_CONTROLLER_H
#define COOPDYN_CONTROLLER_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Of this file. A controller built against another one is refused. */
#define COOPDYN_CONTROLLER_VERSION 3

#define COOPDYN_MAX_MESSAGE 8   /* numbers in one broadcast */
#define COOPDYN_MAX_OPTIONS 64  /* of one controller */
#define COOPDYN_MAX_STATE 65536 /* bytes */

/* Which readings a controller wants: the others cost nothing and are empty. COOPDYN_SETPOINTS is none: it
 * says that the controller commands each channel by a set-point, see coopdyn_command. */
enum coopdyn_reading {
  COOPDYN_DISTANCES = 1,
  COOPDYN_POSE = 2, /* ground truth */
  COOPDYN_CHANNELS = 4,
  COOPDYN_TARGETS = 8,
  COOPDYN_NEIGHBOURS = 16,
  COOPDYN_MESSAGES = 32,
  COOPDYN_COMPASS = 64,
  COOPDYN_SETPOINTS = 128,
  COOPDYN_SUPPORT = 256, /* of the load that the robot carries */
  COOPDYN_MOTION = 512,  /* ground truth: how the body lies and moves */
  COOPDYN_SENSORS = 1024 /* the modules that coopdyn_description.sensors names: lidar, imu, camera, ... */
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
  uint32_t option_count; /* at most COOPDYN_MAX_OPTIONS */
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
  COOPDYN_EFFORT = 4    /* N m or N */
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

/* The robot that a controller drives. Valid until destroy(). */
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
} coopdyn_readings;

/* What one channel is to do. A two-wheel drive whose wheels would be too fast scales both alike. */
typedef struct coopdyn_setpoint {
  uint32_t mode; /* of enum coopdyn_mode, one that the channel takes */
  double reference;
} coopdyn_setpoint;

/* What the robot does in the step. All zero when step() is called: it stands and is silent. */
typedef struct coopdyn_command {
  double forward_m_s, turn_rad_s; /* of a two-wheel drive; beyond the wheels' limit both are scaled alike */
  coopdyn_setpoint* setpoints; /* one for each channel, instead of forward and turn; NULL if describe() does
                                  not ask for COOPDYN_SETPOINTS. Write into it, leave the pointer as it is. */
  uint32_t message_count;      /* numbers to broadcast; 0: nothing */
  double message[COOPDYN_MAX_MESSAGE];
} coopdyn_command;

/* What a controller is made of. Only save() and restore() may be NULL, if state_size is 0. The order of calls
 * is create, reset, [restore,] { step, save }, destroy. C++ exceptions that escape stop the robot, with their
 * text. */
typedef struct coopdyn_controller {
  uint32_t version; /* COOPDYN_CONTROLLER_VERSION; always the first field */
  /* Constant, and valid until the process ends. */
  const coopdyn_description* (*describe)(void);
  /* A new instance; `options` holds one value for each described option. NULL: it cannot drive this robot,
   * and `error` (a text of at most `error_size` bytes, the final 0 included) says why. */
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
