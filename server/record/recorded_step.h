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

#include "server/state/frame.h"

namespace coopdyn {

/// Of one channel in column `channels`: a position of 40 bits, a velocity of 32.
inline constexpr std::size_t kChannelBytes = 5 + 4;

/// What of a step is recorded besides time, hash, poses, and the clients' commands.
struct RecordWhat {
  bool channels = false;     // their positions and velocities
  bool distances = false;    // readings
  bool targets = false;      // readings
  bool controllers = false;  // set-points of loaded controllers
  bool images = false;       // of cameras, as JPEG
  bool operator==(const RecordWhat&) const = default;
};
/// "poses,channels,distances,targets,controllers,images", as far as they are chosen.
std::string ToString(const RecordWhat& what);
/// Reads the same, in any order; also `all`, which is all but images. Nothing if a word is unknown (which
/// goes to `unknown`).
std::optional<RecordWhat> ParseRecordWhat(const std::string& words, std::string& unknown);
/// Everything up to 50 robots, beyond that poses and controllers.
RecordWhat DefaultRecordWhat(std::size_t robots);

/// A set-point that comes in force with a step.
struct CommandRecord {
  std::uint32_t channel = 0;  // index into scene->channels
  bool by_client = false;     // a client sent it for this step; else: a loaded controller, a policy, stop_all
  Setpoint setpoint;
};
/// By increasing channel: u32 channel with bit 31 = by_client, u8 mode, f64 reference; each.
void EncodeCommands(std::span<const CommandRecord> commands, std::vector<std::byte>& blob);
bool DecodeCommands(std::span<const std::byte> blob, std::vector<CommandRecord>& commands);
bool SameBits(const Setpoint& a, const Setpoint& b);

/// Broadcasts of one step: u32 robot, u32 count ≤ 8, count × f64; each. The step is not in the bytes.
void EncodeMessages(std::span<const SentMessage> messages, std::vector<std::byte>& blob);
bool DecodeMessages(std::span<const std::byte> blob, std::uint64_t step, std::vector<SentMessage>& messages);

/// How a joint axis moves, as recorded: rad, rad/s, or m, m/s.
struct ChannelMotion {
  double position = 0, velocity = 0;
  bool operator==(const ChannelMotion&) const = default;
};
/// Of each channel: position as 40-bit two's complement in units of 1e-5, velocity as f32.
void EncodeChannels(std::span<const ChannelState> channels, std::vector<std::byte>& blob);

/// What physics measured for sensors.
struct SensedStep {
  std::vector<double> measured;  // as Frame::measured; empty: not recorded
  std::vector<Contact> contacts;
};
/// Behind the channels: each measured value as f32; then, if the scene measures contacts, a u32 count and of
/// each contact its ends (i32 object, robot, link, collision) and point, normal and force as f32.
void EncodeSensed(const Frame& frame, std::vector<std::byte>& blob);
/// What both have written; without the second part if it ends there.
bool DecodeChannels(std::span<const std::byte> blob, const Scene& scene, std::span<ChannelMotion> channels,
                    SensedStep& sensed);
/// It names what is in `scene`.
bool Fits(const Contact& contact, const Scene& scene);

/// Of each robot in order, its readings as f32: ranges in m, right to left, inf = nothing in range.
void EncodeDistances(const Frame& frame, std::vector<std::byte>& blob);
/// Of each robot and target in order: distance m, bearing rad as f32; nan nan = not seen.
void EncodeTargets(const Frame& frame, std::vector<std::byte>& blob);
bool DecodeFloats(std::span<const std::byte> blob, std::vector<float>& values);

/// Of each score in the order of the scenario: f64 value (nan: it cannot be told), u8 1 if its `until` holds.
void EncodeScores(std::span<const Score> scores, std::vector<std::byte>& blob);
bool DecodeScores(std::span<const std::byte> blob, std::vector<Score>& scores);

/// The actuator of `scene` that drives `channel`. @pre channel < scene.channels.size()
std::size_t ActuatorOf(const Scene& scene, std::size_t channel);

struct RecordedStep {
  std::uint64_t step = 0;
  Nanoseconds time = 0;
  std::uint64_t hash = 0;               // of the exact state
  std::uint64_t scene = 0;              // its number in the file
  std::vector<CommandRecord> commands;  // that came in force with this step
  std::vector<SentMessage> messages;    // sent with this step
  std::vector<BodyState> bodies;        // as recorded poses; empty: not recorded (--record-every)
  std::vector<ChannelMotion> channels;  // empty: not recorded
  SensedStep sensed;
  std::vector<float> distances, targets;  // as encoded; empty: not recorded
  std::vector<Score> scores;              // empty: there are none, or they were not recorded
};

}  // namespace coopdyn
