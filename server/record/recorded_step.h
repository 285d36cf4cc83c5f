// SPDX-License-Identifier: MIT
// One recorded step and the encoding of its parts: little-endian bytes, the columns of table `step`
// (docs/formats.md). Pure functions; decoders return false for inconsistent bytes.
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

/// Per channel in column `channels`: a 40-bit position and a 32-bit velocity.
inline constexpr std::size_t kChannelBytes = 5 + 4;

/// The optional parts of a recorded step. Time, hash, poses and the clients' commands are always recorded.
struct RecordWhat {
  bool channels = false;     // positions and velocities
  bool distances = false;    // readings
  bool targets = false;      // readings
  bool controllers = false;  // set-points of loaded controllers
  bool images = false;       // camera images, as JPEG
  bool operator==(const RecordWhat&) const = default;
};
/// "poses,channels,distances,targets,controllers,images", without the parts not chosen.
std::string ToString(const RecordWhat& what);
/// Parses the same words, in any order; `all` means all but images. Returns nullopt and sets `unknown` if a
/// word is unknown.
std::optional<RecordWhat> ParseRecordWhat(const std::string& words, std::string& unknown);
/// All but images for up to 50 robots; poses and controllers for more.
RecordWhat DefaultRecordWhat(std::size_t robots);

/// A set-point that comes into force with a step.
struct CommandRecord {
  std::uint32_t channel = 0;  // index into scene->channels
  bool by_client = false;  // sent by a client for this step; else by a loaded controller, a policy, stop_all
  Setpoint setpoint;
};
/// Per command, by increasing channel: u32 channel with bit 31 = by_client, u8 mode, f64 reference.
void EncodeCommands(std::span<const CommandRecord> commands, std::vector<std::byte>& blob);
bool DecodeCommands(std::span<const std::byte> blob, std::vector<CommandRecord>& commands);
bool SameBits(const Setpoint& a, const Setpoint& b);

/// Broadcasts of one step, each: u32 robot, u32 count ≤ 8, count × f64. The bytes do not contain the step.
void EncodeMessages(std::span<const SentMessage> messages, std::vector<std::byte>& blob);
bool DecodeMessages(std::span<const std::byte> blob, std::uint64_t step, std::vector<SentMessage>& messages);

/// The recorded motion of a joint axis: rad, rad/s, or m, m/s.
struct ChannelMotion {
  double position = 0, velocity = 0;
  bool operator==(const ChannelMotion&) const = default;
};
/// Per channel: position as 40-bit two's complement in units of 1e-5, velocity as f32.
void EncodeChannels(std::span<const ChannelState> channels, std::vector<std::byte>& blob);

/// Quantities that physics measured for sensors.
struct SensedStep {
  std::vector<double> measured;  // as Frame::measured; empty: not recorded
  std::vector<Contact> contacts;
};
/// Follows the channels: each measured value as f32; then, if the scene measures contacts, a u32 count and
/// per contact its ends (i32 object, robot, link, collision) and point, normal and force as f32.
void EncodeSensed(const Frame& frame, std::vector<std::byte>& blob);
/// Decodes the output of EncodeChannels() and EncodeSensed(); the second part may be missing.
bool DecodeChannels(std::span<const std::byte> blob, const Scene& scene, std::span<ChannelMotion> channels,
                    SensedStep& sensed);
/// Whether the ends of `contact` exist in `scene`.
bool Fits(const Contact& contact, const Scene& scene);

/// Per robot in order, its readings as f32: ranges in m, right to left, inf = nothing in range.
void EncodeDistances(const Frame& frame, std::vector<std::byte>& blob);
/// Per robot and target in order: distance m, bearing rad as f32; nan nan = not seen.
void EncodeTargets(const Frame& frame, std::vector<std::byte>& blob);
bool DecodeFloats(std::span<const std::byte> blob, std::vector<float>& values);

/// Per score in the scenario's order: f64 value (nan: undefined), u8 1 if its `until` holds.
void EncodeScores(std::span<const Score> scores, std::vector<std::byte>& blob);
bool DecodeScores(std::span<const std::byte> blob, std::vector<Score>& scores);

/// The actuator of `scene` that drives `channel`. @pre channel < scene.channels.size()
std::size_t ActuatorOf(const Scene& scene, std::size_t channel);

struct RecordedStep {
  std::uint64_t step = 0;
  Nanoseconds time = 0;
  std::uint64_t hash = 0;               // of the exact state
  std::uint64_t scene = 0;              // scene number in the file
  std::vector<CommandRecord> commands;  // that came into force with this step
  std::vector<SentMessage> messages;    // sent with this step
  std::vector<BodyState> bodies;        // as recorded poses; empty: not recorded (--record-every)
  std::vector<ChannelMotion> channels;  // empty: not recorded
  SensedStep sensed;
  std::vector<float> distances, targets;  // as encoded; empty: not recorded
  std::vector<Score> scores;              // empty: no scores, or not recorded
};

}  // namespace coopdyn
