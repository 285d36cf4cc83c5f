// SPDX-License-Identifier: MIT
// One recorded step, and how its parts are written: little-endian bytes, the columns of table `step`
// (docs/formats.md). Pure functions; decoders return false for bytes that do not add up and leave nothing
// half-read in use.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "server/model/drive.h"
#include "server/state/frame.h"

namespace coopdyn {

/// Of one robot in column `wheels`: two angles of 40 bits, two speeds of 32.
inline constexpr std::size_t kWheelsBytes = 2 * 5 + 2 * 4;

/// What of a step is recorded besides time, hash, poses, and the clients' commands.
struct RecordWhat {
  bool wheels = false;       // angles and speeds
  bool distances = false;    // readings
  bool targets = false;      // readings
  bool controllers = false;  // set-points of loaded controllers
  bool operator==(const RecordWhat&) const = default;
};
/// "poses,wheels,distances,targets,controllers", as far as they are chosen.
std::string ToString(const RecordWhat& what);
/// Reads the same, in any order; also `all`. Nothing if a word is unknown (which goes to `unknown`).
std::optional<RecordWhat> ParseRecordWhat(const std::string& words, std::string& unknown);
/// Everything up to 50 robots, beyond that poses and controllers.
RecordWhat DefaultRecordWhat(std::size_t robots);

/// The wheels of a robot's drive: left, right; zeros without a drive.
struct WheelStates {
  std::array<double, 2> angle_rad{}, speed_rad_s{};
};
WheelStates WheelsOf(const Frame& frame, std::size_t robot);
WheelSpeeds WheelSetpoints(const Frame& frame, std::size_t robot);

/// A set-point that comes in force with a step.
struct CommandRecord {
  std::uint32_t robot = 0;  // index into scene->robots
  bool by_client = false;   // a client sent it for this step; else: a loaded controller, a policy, stop_all
  WheelSpeeds setpoint{};   // rad/s
};
/// By increasing robot: u32 robot with bit 31 = by_client, f64 left, f64 right; each.
void EncodeCommands(std::span<const CommandRecord> commands, std::vector<std::byte>& blob);
bool DecodeCommands(std::span<const std::byte> blob, std::vector<CommandRecord>& commands);

/// Broadcasts of one step: u32 robot, u32 count ≤ 8, count × f64; each. The step is not in the bytes.
void EncodeMessages(std::span<const SentMessage> messages, std::vector<std::byte>& blob);
bool DecodeMessages(std::span<const std::byte> blob, std::uint64_t step, std::vector<SentMessage>& messages);

/// Of each robot: angle left, right as 40-bit two's complement in 1e-5 rad, speed left, right as f32 rad/s.
void EncodeWheels(const Frame& frame, std::vector<std::byte>& blob);
bool DecodeWheels(std::span<const std::byte> blob, std::span<WheelStates> robots);

/// Of each robot in order, its readings as f32: ranges in m, right to left, inf = nothing in range.
void EncodeDistances(const Frame& frame, std::vector<std::byte>& blob);
/// Of each robot and target in order: distance m, bearing rad as f32; nan nan = not seen.
void EncodeTargets(const Frame& frame, std::vector<std::byte>& blob);
bool DecodeFloats(std::span<const std::byte> blob, std::vector<float>& values);

struct RecordedStep {
  std::uint64_t step = 0;
  Nanoseconds time = 0;
  std::uint64_t hash = 0;                 // of the exact state
  std::uint64_t scene = 0;                // its number in the file
  std::vector<CommandRecord> commands;    // that came in force with this step
  std::vector<SentMessage> messages;      // sent with this step
  std::vector<BodyState> bodies;          // as recorded poses; empty: not recorded (--record-every)
  std::vector<WheelStates> robots;        // empty: not recorded
  std::vector<float> distances, targets;  // as encoded; empty: not recorded
};

}  // namespace coopdyn
