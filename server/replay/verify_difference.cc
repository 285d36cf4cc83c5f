// SPDX-License-Identifier: MIT
#include "server/replay/verify_difference.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "server/record/run_tables.h"
#include "server/replay/run_columns.h"
#include "server/state/pose_codec.h"

namespace coopdyn {

namespace {

/// Exceeds the error of a quaternion component after rounding and normalising.
constexpr double kTurnRounding = 3e-6;

bool SameBits(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

std::string Exact(double value) {
  return fmt::format("{:.17g}", value);
}

/// The numbers of a body in memory order (state_hash.cc checks the layout).
constexpr std::array kBodyFields{
    "x_m",  "y_m",  "z_m",  "qw",   "qx",   "qy",     "qz",     "R_11",   "R_12",     "R_13",     "R_21",
    "R_22", "R_23", "R_31", "R_32", "R_33", "vx_m_s", "vy_m_s", "vz_m_s", "wx_rad_s", "wy_rad_s", "wz_rad_s"};
using BodyNumbers = std::array<double, kBodyFields.size()>;

BodyNumbers NumbersOf(const BodyState& body) {
  BodyNumbers numbers;
  std::memcpy(numbers.data(), static_cast<const void*>(&body), sizeof numbers);
  return numbers;
}

/// If the values differ, stores them in `difference` and returns true.
template <typename Number>
bool Differs(Number recorded, Number repeated, Difference& difference) {
  if constexpr (std::is_same_v<Number, double>) {
    if (SameBits(recorded, repeated)) return false;
    difference.recorded = Exact(recorded);
    difference.repeated = Exact(repeated);
  } else {
    if (recorded == repeated) return false;
    difference.recorded = std::to_string(recorded);
    difference.repeated = std::to_string(repeated);
  }
  return true;
}

std::optional<Difference> FindBody(const Frame& recorded, const Frame& repeated) {
  for (std::size_t i = 0; i < recorded.bodies.size(); ++i) {
    const BodyState &a = recorded.bodies[i], &b = repeated.bodies[i];
    const BodyNumbers ours = NumbersOf(a), theirs = NumbersOf(b);
    Difference difference = DifferenceAt(repeated, "", "sleep_counter");
    bool differs = Differs(a.sleep_counter, b.sleep_counter, difference);
    for (std::size_t k = ours.size(); k-- > 0;) {  // backwards: the first difference is stored last
      if (!Differs(ours[k], theirs[k], difference)) continue;
      difference.field = kBodyFields[k];
      differs = true;
    }
    if (!differs) continue;
    difference.what = BodyNames(*repeated.scene)[i];
    return difference;
  }
  return std::nullopt;
}

/// The name of the robot of `channel`.
const std::string& RobotOf(const Scene& scene, std::size_t channel) {
  return scene.robots[static_cast<std::size_t>(scene.channels[channel].robot)].entry.name;
}

std::optional<Difference> FindMotion(const Frame& recorded, const Frame& repeated) {
  for (std::size_t i = 0; i < recorded.channels.size(); ++i) {
    const ChannelState &a = recorded.channels[i], &b = repeated.channels[i];
    const std::string& name = ChannelName(*repeated.scene, i);
    const std::string unit = ChannelUnit(*repeated.scene, i);
    Difference difference = DifferenceAt(repeated, RobotOf(*repeated.scene, i), name + "_" + unit);
    if (Differs(a.position, b.position, difference)) return difference;
    difference.field = name + "_" + SetpointUnit(unit, ControlMode::kVelocity);
    if (Differs(a.velocity, b.velocity, difference)) return difference;
  }
  for (std::size_t i = 0; i < recorded.commanded.size(); ++i) {
    const SceneActuator& actuator = recorded.scene->actuators[i];
    const auto& robot = repeated.scene->robots[static_cast<std::size_t>(actuator.robot)];
    Difference difference = DifferenceAt(repeated, robot.entry.name, "commanded");
    const int a = recorded.commanded[i], b = repeated.commanded[i];
    if (actuator.channel_count > 0 && Differs(a, b, difference)) return difference;
  }
  return std::nullopt;
}

std::string Worded(const SentMessage* sent) {
  if (sent == nullptr) return "none";
  std::string text;
  for (std::uint32_t i = 0; i < sent->message.count; ++i) {
    text += (i == 0 ? "" : " ") + Exact(sent->message.values[i]);
  }
  return text.empty() ? "empty" : text;
}

bool Same(const SentMessage& a, const SentMessage& b) {
  return a.robot == b.robot && a.step == b.step && a.message.count == b.message.count &&
         std::equal(a.message.values.begin(), a.message.values.begin() + a.message.count,
                    b.message.values.begin(), SameBits);
}

/// The first place where two lists of broadcasts differ.
std::optional<Difference> FindMessage(std::span<const SentMessage> recorded,
                                      std::span<const SentMessage> repeated, const Frame& frame) {
  for (std::size_t i = 0; i < std::max(recorded.size(), repeated.size()); ++i) {
    const SentMessage* a = i < recorded.size() ? &recorded[i] : nullptr;
    const SentMessage* b = i < repeated.size() ? &repeated[i] : nullptr;
    if (a != nullptr && b != nullptr && Same(*a, *b)) continue;
    // If sender or step differ, the other list lacks the earlier broadcast.
    if (a != nullptr && b != nullptr && (a->step != b->step || a->robot != b->robot)) {
      const bool ours = a->step != b->step ? a->step < b->step : a->robot < b->robot;
      (ours ? b : a) = nullptr;
    }
    const SentMessage& first = a != nullptr ? *a : *b;
    const std::vector<SceneRobot>& robots = frame.scene->robots;
    return DifferenceAt(frame, first.robot < robots.size() ? robots[first.robot].entry.name : "no robot",
                        "broadcast", Worded(a), Worded(b));
  }
  return std::nullopt;
}

/// The first of `recorded` that differs from the output of `encode` for `frame`. `name` returns the robot and
/// the name of the reading at an index.
template <typename Name>
std::optional<Difference> FindReading(const std::vector<float>& recorded, const Frame& frame,
                                      void (*encode)(const Frame&, std::vector<std::byte>&), Name name) {
  if (recorded.empty()) return std::nullopt;
  std::vector<std::byte> blob;
  encode(frame, blob);
  std::vector<float> repeated;
  DecodeFloats(blob, repeated);
  const auto same = [](float a, float b) {
    return std::bit_cast<std::uint32_t>(a) == std::bit_cast<std::uint32_t>(b);
  };
  const auto [ours, theirs] =
      std::mismatch(repeated.begin(), repeated.end(), recorded.begin(), recorded.end(), same);
  if (ours == repeated.end() && theirs == recorded.end()) return std::nullopt;
  const auto worded = [](auto at, auto end) { return at == end ? "none" : fmt::format("{}", *at); };
  std::pair<std::size_t, std::string> reading = name(static_cast<std::size_t>(ours - repeated.begin()));
  const std::vector<SceneRobot>& robots = frame.scene->robots;
  const bool is_of_robot = reading.first < robots.size();
  return DifferenceAt(frame, is_of_robot ? robots[reading.first].entry.name : "the readings",
                      is_of_robot ? std::move(reading.second) : "after those of the last robot",
                      worded(theirs, recorded.end()), worded(ours, repeated.end()), false);
}

std::optional<Difference> FindDistance(const std::vector<float>& recorded, const Frame& frame) {
  return FindReading(recorded, frame, EncodeDistances, [&frame](std::size_t sensor) {
    std::size_t robot = 0;
    for (const SceneRobot& of : frame.scene->robots) {
      if (sensor < of.entry.model->sector_count()) break;
      sensor -= of.entry.model->sector_count();
      ++robot;
    }
    return std::pair(robot, fmt::format("d{}_m", sensor + 1));
  });
}

std::optional<Difference> FindTarget(const std::vector<float>& recorded, const Frame& frame) {
  return FindReading(recorded, frame, EncodeTargets, [&frame](std::size_t place) {
    const std::vector<Target>& targets = frame.scene->targets;
    const std::size_t each = 2 * std::max<std::size_t>(targets.size(), 1);  // readings of a robot
    std::string field = place % 2 == 0 ? "_distance_m" : "_bearing_rad";
    std::string error;
    for (const TargetColumn& column : ChooseColumns(std::span(&frame.scene, 1), {}, {}, error).targets) {
      const std::size_t target = place % each / 2;
      if (target < targets.size() && column.id == targets[target].id) field.insert(0, column.label);
    }
    return std::pair(place / each, std::move(field));
  });
}

/// Compares the recorded motion of the channels.
std::optional<Difference> FindRecordedMotion(const RecordedStep& step, const Frame& frame) {
  if (step.channels.size() != frame.channels.size()) return std::nullopt;
  std::vector<std::byte> blob;
  EncodeChannels(frame.channels, blob);
  std::vector<ChannelMotion> repeated(step.channels.size());
  SensedStep none;
  DecodeChannels(blob, *frame.scene, repeated, none);
  const auto [ours, theirs] = std::mismatch(repeated.begin(), repeated.end(), step.channels.begin());
  if (ours == repeated.end()) return std::nullopt;
  const auto channel = static_cast<std::size_t>(ours - repeated.begin());
  const auto worded = [unit = ChannelUnit(*frame.scene, channel)](const ChannelMotion& motion) {
    return fmt::format("{:.5f} {}, {} {}/s", motion.position, unit, motion.velocity, unit);
  };
  return DifferenceAt(frame, RobotOf(*frame.scene, channel), ChannelName(*frame.scene, channel),
                      worded(*theirs), worded(*ours), false);
}

/// Compares the recorded values that physics measured for sensors.
std::optional<Difference> FindMeasured(const RecordedStep& step, const Frame& frame) {
  const std::vector<double>& recorded = step.sensed.measured;
  if (recorded.size() != frame.measured.size()) return std::nullopt;
  for (std::size_t i = 0; i < frame.scene->robots.size(); ++i) {
    const SceneRobot& robot = frame.scene->robots[i];
    const RobotModel& model = *robot.entry.model;
    for (std::size_t sensor = 0; sensor < model.sensors.size(); ++sensor) {
      const std::size_t first = static_cast<std::size_t>(robot.first_measured) + model.FirstMeasured(sensor);
      for (std::size_t k = 0; k < MeasuredCount(model.sensors[sensor].kind); ++k) {
        const double ours = static_cast<float>(frame.measured[first + k]), theirs = recorded[first + k];
        if (ours == theirs) continue;
        return DifferenceAt(frame, robot.entry.name,
                            fmt::format("{} value {}", model.sensors[sensor].name, k + 1),
                            fmt::format("{}", theirs), fmt::format("{}", ours), false);
      }
    }
  }
  return std::nullopt;
}

std::optional<Difference> FindRecordedPose(const RecordedStep& step, const Frame& frame) {
  if (step.bodies.size() != frame.bodies.size()) return std::nullopt;
  std::vector<std::byte> blob;
  EncodePoses(frame.bodies, blob);
  std::vector<BodyState> repeated(frame.bodies.size());
  DecodePoses(blob, repeated);
  const auto same = [](const BodyState& a, const BodyState& b) {
    return a.p_WB == b.p_WB && a.q_WB == b.q_WB && a.frozen() == b.frozen();
  };
  if (std::equal(repeated.begin(), repeated.end(), step.bodies.begin(), same)) return std::nullopt;
  if (auto found = FindPose(step.bodies, frame)) return found;
  return DifferenceAt(frame, "the recorded poses", "rounding", "other bits", "those of the exact state",
                      false);
}

}  // namespace

Difference DifferenceAt(const Frame& frame, std::string what, std::string field, std::string recorded,
                        std::string repeated, bool exact) {
  return {frame.step,          frame.time, std::move(what), std::move(field), std::move(recorded),
          std::move(repeated), exact,      false,           frame.step};
}

std::optional<Difference> FindSetpoint(std::span<const Setpoint> recorded, const Frame& repeated,
                                       const std::function<bool(std::size_t channel)>& looks_at) {
  for (std::size_t i = 0; i < recorded.size(); ++i) {
    const Setpoint& ours = repeated.channels[i].setpoint;
    if (SameBits(recorded[i], ours) || (looks_at && !looks_at(i))) continue;
    const std::string& name = ChannelName(*repeated.scene, i);
    const std::string unit = SetpointUnit(ChannelUnit(*repeated.scene, i), recorded[i].mode);
    Difference difference = DifferenceAt(repeated, RobotOf(*repeated.scene, i), name + "_setpoint_" + unit);
    if (Differs(recorded[i].reference, ours.reference, difference)) return difference;
    difference.field = name + "_mode";
    if (Differs(static_cast<int>(recorded[i].mode), static_cast<int>(ours.mode), difference))
      return difference;
  }
  return std::nullopt;
}

std::optional<Difference> FindMessage(std::span<const SentMessage> recorded, const Frame& repeated) {
  const std::vector<SentMessage>& all = repeated.messages;
  const auto first = std::find_if(all.begin(), all.end(),
                                  [&](const SentMessage& sent) { return sent.step == repeated.step; });
  return FindMessage(recorded, std::span(first, all.end()), repeated);
}

std::optional<Difference> FindPose(std::span<const BodyState> recorded, const Frame& repeated) {
  if (recorded.size() != repeated.bodies.size()) return std::nullopt;
  std::vector<std::byte> blob;
  int exponent = 0;  // the coarser of both units
  for (const std::span<const BodyState> bodies : {recorded, std::span<const BodyState>(repeated.bodies)}) {
    blob.clear();
    EncodePoses(bodies, blob);
    exponent = std::max(exponent, std::to_integer<int>(blob.front()));
  }
  const double unit_m = std::ldexp(1e-6, exponent);
  for (std::size_t i = 0; i < recorded.size(); ++i) {
    const BodyState& ours = repeated.bodies[i];
    std::array<double, 4> turn = recorded[i].q_WB;
    double dot = 0;
    for (std::size_t k = 0; k < 4; ++k) dot += turn[k] * ours.q_WB[k];
    for (double& component : turn) component = dot < 0 ? -component : component;
    const BodyNumbers numbers = NumbersOf(ours);
    for (std::size_t k = 0; k < 7; ++k) {
      const bool place = k < 3;
      const double told = place ? recorded[i].p_WB[static_cast<Eigen::Index>(k)] : turn[k - 3];
      const double rounding = place ? 0.501 * unit_m : kTurnRounding;
      if (std::abs(told - numbers[k]) <= rounding) continue;
      return DifferenceAt(repeated, BodyNames(*repeated.scene)[i], kBodyFields[k],
                          place ? fmt::format("{:.6f}", told) : fmt::format("{:.7f}", told),
                          Exact(numbers[k]), false);
    }
  }
  return std::nullopt;
}

std::optional<Difference> FindInRow(const RecordedStep& step, const Frame& repeated) {
  if (auto found = FindRecordedPose(step, repeated)) return found;
  if (auto found = FindRecordedMotion(step, repeated)) return found;
  if (auto found = FindMeasured(step, repeated)) return found;
  if (auto found = FindDistance(step.distances, repeated)) return found;
  return FindTarget(step.targets, repeated);
}

bool CanCompare(const Frame& one, const Frame& other) {
  const auto same = [](const SceneActuator& a, const SceneActuator& b) {
    return a.robot == b.robot && a.first_channel == b.first_channel && a.channel_count == b.channel_count;
  };
  return one.bodies.size() == other.bodies.size() && one.channels.size() == other.channels.size() &&
         one.commanded.size() == other.commanded.size() &&
         one.scene->robots.size() == other.scene->robots.size() &&
         std::ranges::equal(one.scene->actuators, other.scene->actuators, same);
}

std::optional<Difference> FindExact(const Frame& recorded, const Frame& repeated) {
  std::vector<Setpoint> setpoints;
  for (const ChannelState& channel : recorded.channels) setpoints.push_back(channel.setpoint);
  if (auto found = FindSetpoint(setpoints, repeated)) return found;
  if (auto found = FindBody(recorded, repeated)) return found;
  Difference difference = DifferenceAt(repeated, "solver", "seed");
  if (Differs(recorded.solver_seed, repeated.solver_seed, difference)) return difference;
  difference.what = "run";
  difference.field = "time_ns";
  if (Differs(recorded.time, repeated.time, difference)) return difference;
  difference.field = "seed";
  if (Differs(recorded.seed, repeated.seed, difference)) return difference;
  if (auto found = FindMotion(recorded, repeated)) return found;
  return FindMessage(recorded.messages, repeated.messages, repeated);
}

void AddLine(const std::string& line, std::string& text) {
  if (!line.empty()) text += (text.empty() ? "" : "\n") + line;
}

std::string CannotLoadText(const RunReader& reader, const Diagnostics& diagnostics) {
  return reader.file() + " cannot be repeated, its scenario does not load:\n" + diagnostics.ToString();
}

std::string CommandsOf(const RecordedStep& step, const Scene& scene) {
  const auto is_of_scene = [&scene](const CommandRecord& command) {
    return command.channel < scene.channels.size();
  };
  if (!std::ranges::all_of(step.commands, is_of_scene)) return {};
  constexpr std::size_t kNamed = 5;
  std::size_t count = 0;
  std::string text;
  for (auto next = step.commands.begin(); next != step.commands.end(); ++count) {
    const std::size_t actuator = ActuatorOf(scene, next->channel);
    const bool by_client = next->by_client;
    std::string numbers;
    for (; next != step.commands.end() && ActuatorOf(scene, next->channel) == actuator; ++next) {
      numbers += (numbers.empty() ? "" : ", ") + Exact(next->setpoint.reference);
    }
    if (count >= kNamed) continue;
    const auto robot = static_cast<std::size_t>(scene.actuators[actuator].robot);
    text += fmt::format("{}{} ({} rad/s{})", text.empty() ? "" : ", ", scene.robots[robot].entry.name,
                        numbers, by_client ? "" : ", not by a client");
  }
  if (text.empty()) return {};
  if (count > kNamed) text += fmt::format(" and {} more", count - kNamed);
  return "set-points that came in force with step " + std::to_string(step.step) + ": " + text;
}

std::string ToString(const VerifyReport& report) {
  std::string text;
  if (!report.error.empty()) {
    text = report.error;
  } else if (report.difference) {
    const Difference& difference = *report.difference;
    const std::size_t width = std::max(difference.recorded_is.size(), difference.repeated_is.size());
    text = fmt::format("differs from step {} on, t = {:g} s: {}{} {}\n", difference.step,
                       ToSeconds(difference.time), difference.what, difference.of_file ? ": its" : "",
                       difference.field);
    text += fmt::format("  {:{}}  {}{}\n", difference.recorded_is, width, difference.recorded,
                        difference.exact ? "" : " (as rounded)");
    text += fmt::format("  {:{}}  {}\n", difference.repeated_is, width, difference.repeated);
    if (difference.value_step > difference.step) {
      text += fmt::format("  at step {}, where it shows first\n", difference.value_step);
    }
    if (!difference.note.empty()) text += "  " + difference.note + "\n";
    text += fmt::format("{} step{} before it {} equal", report.steps, report.steps == 1 ? "" : "s",
                        report.steps == 1 ? "is" : "are");
  } else {
    text = fmt::format("equal, {} step{}", report.steps, report.steps == 1 ? "" : "s");
  }
  if (report.not_verified > 0) {
    // In a damaged file, steps may have been lost or removed.
    const bool lost = report.error.empty() && !(report.difference && report.difference->of_file);
    text += fmt::format("; {}{} step{} could not be verified", report.not_verified, lost ? " lost" : "",
                        report.not_verified == 1 ? "" : "s");
  }
  while (text.ends_with('\n')) text.pop_back();
  text += '\n';
  if (!report.warning.empty()) text += "warning: " + report.warning + '\n';
  return text;
}

}  // namespace coopdyn
