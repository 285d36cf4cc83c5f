// SPDX-License-Identifier: MIT
// The layout of the two areas that the daemon shares with the controllers' process. The daemon writes `in`;
// the child can only read it. The child writes `out`, so the daemon trusts no value in it, reads each value
// once and keeps its own places. Places are byte offsets from the area's start. Both sides are the same
// program.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "clients/plugin/controller.h"

namespace coopdyn {

/// Byte offset in one of the areas.
using Place = std::uint64_t;

/// The operation to run on the listed items.
enum class Operation : std::uint32_t {
  kLoad,    // items: files
  kCreate,  // items: robots
  kStep,    // items: robots
  kEnd,     // destroys all instances and exits
};

inline constexpr std::size_t kMaxWorkers = 64;
inline constexpr std::size_t kTextSize = 240;
inline constexpr std::size_t kNameSize = 64;

/// At the start of `in`, one page.
struct InHeader {
  std::atomic<std::uint32_t> go;      // futex: changes with each operation sent
  std::atomic<std::uint32_t> yields;  // 1: both are on one core and yield it to each other
  Operation operation;
  std::uint64_t serial;  // of the operation; unchanged when it is finished after a crash
  std::uint32_t file_count, robot_count, item_count, workers;
  std::uint32_t reviving;  // 1: kCreate only restores lost instances, without results
  Place items;             // std::uint32_t; room for all files or all robots
  Place files;             // FileSetup
  Place file_results;      // in `out`: FileResult
  Place robots;            // RobotSetup
  Place robot_results;     // in `out`: RobotResult
  Place texts;             // in `out`: char[kTextSize] for each robot
  Place readings;          // RobotReadings
  // Of a supervisor:
  Place bodies, scores;  // coopdyn_body and coopdyn_score, written before each step
  std::size_t body_count, score_count;
  Place supervision;  // in `out`: coopdyn_supervision; its pointer is null
  Place moves;        // in `out`: coopdyn_move[COOPDYN_MAX_MOVES]
  std::uint64_t seed, step;
  double time_s, step_s;
  std::uint64_t in_bytes, out_bytes;  // sizes of the areas
  std::uint64_t memory_bytes;         // limit for the controllers; 0: none
  std::int64_t share_from_ns;         // a longer step is distributed over all workers
};

struct FileSetup {
  Place path;  // ends with 0
};

inline constexpr std::int32_t kNoState = -1;

/// The constant facts of a robot. Strings end with 0; pointers are null.
struct RobotSetup {
  coopdyn_robot robot;
  std::uint32_t file;
  std::int32_t restore;  // kCreate: which of the states to restore, or kNoState
  Place name;
  Place bearing_rad, opening_rad, max_m;  // distance_count doubles each
  Place joints;                           // channel_count coopdyn_joint; pointers are null
  Place joint_texts, joint_text_bytes;    // module and name of each of these, each ending with 0
  Place options;                          // doubles: ControllerDescription::Values()
  Place distances;                        // doubles, written before each step
  Place channels;                         // coopdyn_channel, written before each step
  Place sensors;                          // sensor_count coopdyn_sensor; pointers are null
  Place sensor_texts, sensor_text_bytes;  // module and type of each of these, each ending with 0
  Place sensed;                           // SensorPlace of each
  Place readings_begin;                   // start of the sensors' readings
  Place links;                            // motor_count, then mapped_count coopdyn_mapped; pointers are null
  Place link_texts, link_text_bytes;      // name of each of these, each ending with 0
  Place option_texts, option_text_bytes;  // name of each of option_count options, each ending with 0
  Place mapped;                           // mapped_count doubles, written before each exchange
  std::uint64_t exchange_steps;           // COOPDYN_MAPPED: steps per exchange; else 1
  Place motors;                           // in `out`: motor_count doubles
  Place setpoints;                        // in `out`: coopdyn_setpoint, if the controller uses them
  Place logs;                             // in `out`: coopdyn_logged[COOPDYN_MAX_LOGS]
  Place states[2];                        // in `out`: written alternately, by the serial's parity
};

/// Where a sensor's reading is written before each step.
struct SensorPlace {
  Place values;        // doubles
  Place image;         // bytes of the picture
  std::uint64_t step;  // of its sample
};

/// A robot's readings, as in coopdyn_readings; those that its controller does not request are 0.
struct RobotReadings {
  double x_m, y_m, heading_rad, forward_m_s, turn_rad_s, compass_rad;
  double support_x_m, support_y_m, support_rad;
  double height_m, roll_rad, pitch_rad;
  double velocity_m_s[3], angular_velocity_rad_s[3];
  std::size_t distance_count, channel_count, target_count, neighbour_count, heard_count;
  Place targets, neighbours, heard;
};

/// A worker's current item: (count of items begun << 32) + item + 1; lower half 0: idle.
struct alignas(64) WorkerProgress {
  std::atomic<std::uint64_t> word;
};

/// At the start of `out`.
struct OutHeader {
  alignas(64) std::atomic<std::uint32_t> reply;  // futex: set to `go` when the operation is done
  std::atomic<std::uint32_t> sleeps;             // 1: the child must be woken; a hint
  WorkerProgress workers[kMaxWorkers];
  std::atomic<std::uint32_t> out_of_memory;  // the item + 1 that ran out of memory
};

struct OptionRecord {
  char name[kNameSize];
  char help[kTextSize];
  double value, min, max;
};

struct FileResult {
  std::atomic<std::uint64_t> done;     // the serial, once loaded or rejected
  std::atomic<std::uint64_t> step_ns;  // in the last timed step, sum over all robots
  std::uint32_t refused;               // 1: `why`
  std::uint32_t readings, state_size, option_count;
  char why[2 * kTextSize];
  char help[kTextSize];
  char sensors[kTextSize];
  OptionRecord options[COOPDYN_MAX_OPTIONS];
};

struct RobotResult {
  std::atomic<std::uint64_t> done;  // the serial, once the item is complete
  std::uint32_t failed;             // 1: the robot's text says why
  coopdyn_command command;
};

/// A copy of a value that another process may change at any time.
template <typename T>
T Once(const T& shared) {
  T copy;
  std::memcpy(&copy, &shared, sizeof(T));
  std::atomic_signal_fence(std::memory_order_seq_cst);  // the compiler must not read `shared` again
  return copy;
}

/// Copies the used values of a command, each read once: no pointers, and no messages beyond their count.
inline void CopyCommand(const coopdyn_command& from, coopdyn_command& to) {
  to.forward_m_s = Once(from.forward_m_s);
  to.turn_rad_s = Once(from.turn_rad_s);
  const std::uint32_t count = Once(from.message_count);
  to.message_count = count;
  for (std::uint32_t i = 0; i < count && i < COOPDYN_MAX_MESSAGE; ++i) to.message[i] = Once(from.message[i]);
  to.log_count = Once(from.log_count);
  to.end_run = Once(from.end_run);
}

static_assert(std::atomic<std::uint64_t>::is_always_lock_free);
static_assert(std::atomic<std::uint32_t>::is_always_lock_free);
static_assert(sizeof(InHeader) <= 4096);

}  // namespace coopdyn
