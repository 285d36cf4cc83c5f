// SPDX-License-Identifier: MIT
// What lies in the two areas that the daemon shares with the controllers' process. `in` is written by the
// daemon, the child can only read it. `out` is written by the child, so the daemon trusts no value in it and
// reads each once; it knows by itself where things lie. Places are byte offsets from the area's start. Both
// sides are the same program.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "clients/plugin/controller.h"

namespace coopdyn {

/// Byte offset in one of the areas.
using Place = std::uint64_t;

/// What the child is to do with the items listed.
enum class Operation : std::uint32_t {
  kLoad,    // items: files
  kCreate,  // items: robots
  kStep,    // items: robots
  kEnd,     // destroys all instances and ends
};

inline constexpr std::size_t kMaxWorkers = 64;
inline constexpr std::size_t kTextSize = 240;
inline constexpr std::size_t kNameSize = 64;

/// At the start of `in`, one page.
struct InHeader {
  std::atomic<std::uint32_t> go;      // futex: another value for each operation sent
  std::atomic<std::uint32_t> yields;  // 1: both are on one core, and each yields it to the other
  Operation operation;
  std::uint64_t serial;  // of the operation; the same again when it is finished after a crash
  std::uint32_t file_count, robot_count, item_count, workers;
  std::uint32_t reviving;  // 1: kCreate leaves results alone, it only brings back what was lost
  Place items;             // std::uint32_t; room for as many as there are files or robots
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
  std::uint64_t in_bytes, out_bytes;  // of the areas
  std::uint64_t memory_bytes;         // that the controllers may use; 0: no limit
  std::int64_t share_from_ns;         // a step that takes longer than this is shared out to all workers
};

struct FileSetup {
  Place path;  // ends with 0
};

inline constexpr std::int32_t kNoState = -1;

/// What does not change from step to step. Strings end with 0; pointers are null.
struct RobotSetup {
  coopdyn_robot robot;
  std::uint32_t file;
  std::int32_t restore;  // kCreate: which of the states to restore, or kNoState
  Place name;
  Place bearing_rad, opening_rad, max_m;  // distance_count doubles each
  Place joints;                           // channel_count coopdyn_joint; pointers are null
  Place joint_texts, joint_text_bytes;    // module and name of each of these, each ends with 0
  Place options;                          // doubles: one for each described, or given if any are taken
  Place distances;                        // doubles, written before each step
  Place channels;                         // coopdyn_channel, likewise
  Place sensors;                          // sensor_count coopdyn_sensor; pointers are null
  Place sensor_texts, sensor_text_bytes;  // module and type of each of these, each ends with 0
  Place sensed;                           // SensorPlace of each
  Place readings_begin;                   // of these
  Place links;                            // motor_count, then mapped_count coopdyn_mapped; pointers are null
  Place link_texts, link_text_bytes;      // name of each of these, each ends with 0
  Place option_texts, option_text_bytes;  // name of each of option_count options, likewise
  Place mapped;                           // mapped_count doubles, written before each exchange
  std::uint64_t exchange_steps;           // COOPDYN_MAPPED: of one exchange; else 1
  Place motors;                           // in `out`: motor_count doubles
  Place setpoints;                        // in `out`: coopdyn_setpoint, if the controller gives them
  Place logs;                             // in `out`: coopdyn_logged[COOPDYN_MAX_LOGS]
  Place states[2];                        // in `out`: written in turn, by the serial's parity
};

/// Where a sensor's reading is written before each step.
struct SensorPlace {
  Place values;        // doubles
  Place image;         // bytes of a picture
  std::uint64_t step;  // of its sample
};

/// What a robot feels, as far as its controller asks for it; the rest is 0. As in coopdyn_readings.
struct RobotReadings {
  double x_m, y_m, heading_rad, forward_m_s, turn_rad_s, compass_rad;
  double support_x_m, support_y_m, support_rad;
  double height_m, roll_rad, pitch_rad;
  double velocity_m_s[3], angular_velocity_rad_s[3];
  std::size_t distance_count, channel_count, target_count, neighbour_count, heard_count;
  Place targets, neighbours, heard;
};

/// What a worker has in hand: (count of items begun << 32) + item + 1; item 0: nothing.
struct alignas(64) WorkerProgress {
  std::atomic<std::uint64_t> word;
};

/// At the start of `out`.
struct OutHeader {
  alignas(64) std::atomic<std::uint32_t> reply;  // futex: `go`, when the operation is done
  std::atomic<std::uint32_t> sleeps;             // 1: the child has to be woken; a hint
  WorkerProgress workers[kMaxWorkers];
  std::atomic<std::uint32_t> out_of_memory;  // the item + 1 for which there was no memory any more
};

struct OptionRecord {
  char name[kNameSize];
  char help[kTextSize];
  double value, min, max;
};

struct FileResult {
  std::atomic<std::uint64_t> done;     // the serial, once loaded or refused
  std::atomic<std::uint64_t> step_ns;  // in the last step that was timed, all robots together
  std::uint32_t refused;               // 1: `why`
  std::uint32_t readings, state_size, option_count;
  char why[2 * kTextSize];
  char help[kTextSize];
  char sensors[kTextSize];
  OptionRecord options[COOPDYN_MAX_OPTIONS];
};

struct RobotResult {
  std::atomic<std::uint64_t> done;  // the serial, once the item is complete
  std::uint32_t failed;             // 1: its text says why
  coopdyn_command command;
};

/// A copy of what another process may change at any moment.
template <typename T>
T Once(const T& shared) {
  T copy;
  std::memcpy(&copy, &shared, sizeof(T));
  std::atomic_signal_fence(std::memory_order_seq_cst);  // the compiler must not read it again
  return copy;
}

/// Copies what counts of a command, each number read once: no pointers, and no messages beyond their count.
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
