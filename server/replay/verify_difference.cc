// SPDX-License-Identifier: MIT
#include "server/replay/verify_difference.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <string_view>
#include <vector>

#include "server/record/pose_codec.h"
#include "server/record/run_tables.h"

namespace coopdyn {

namespace {

constexpr std::array<const char*, 2> kSetpointFields{"setpoint_left_rad_s", "setpoint_right_rad_s"};
/// More than what rounding and normalising make of a component of a quaternion.
constexpr double kTurnRounding = 3e-6;

bool SameBits(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

std::string Exact(double value) {
  return fmt::format("{:.17g}", value);
}

/// A number of a body, as far as it is exact.
struct Field {
  const char* name;
  double value;
};

std::vector<Field> FieldsOf(const BodyState& body) {
  const auto& R = body.R_WB;
  return {{"x_m", body.p_WB.x()},
          {"y_m", body.p_WB.y()},
          {"z_m", body.p_WB.z()},
          {"qw", body.q_WB[0]},
          {"qx", body.q_WB[1]},
          {"qy", body.q_WB[2]},
          {"qz", body.q_WB[3]},
          {"R_11", R[0]},
          {"R_12", R[1]},
          {"R_13", R[2]},
          {"R_21", R[3]},
          {"R_22", R[4]},
          {"R_23", R[5]},
          {"R_31", R[6]},
          {"R_32", R[7]},
          {"R_33", R[8]},
          {"vx_m_s", body.v_WB.x()},
          {"vy_m_s", body.v_WB.y()},
          {"vz_m_s", body.v_WB.z()},
          {"wx_rad_s", body.w_WB.x()},
          {"wy_rad_s", body.w_WB.y()},
          {"wz_rad_s", body.w_WB.z()}};
}

/// Sets the values if they differ.
bool Differs(double recorded, double repeated, Difference& difference) {
  if (SameBits(recorded, repeated)) return false;
  difference.recorded = Exact(recorded);
  difference.repeated = Exact(repeated);
  difference.exact = true;
  return true;
}

template <typename Number>
bool Differs(Number recorded, Number repeated, Difference& difference)
  requires(std::integral<Number>)
{
  if (recorded == repeated) return false;
  difference.recorded = std::to_string(recorded);
  difference.repeated = std::to_string(repeated);
  difference.exact = true;
  return true;
}

std::optional<Difference> FindBody(const Frame& recorded, const Frame& repeated) {
  for (std::size_t i = 0; i < recorded.bodies.size(); ++i) {
    const BodyState &a = recorded.bodies[i], &b = repeated.bodies[i];
    const std::vector<Field> ours = FieldsOf(a), theirs = FieldsOf(b);
    Difference difference = DifferenceAt(repeated, "", "sleep_counter");
    bool differs = Differs(a.sleep_counter, b.sleep_counter, difference);
    for (std::size_t k = ours.size(); k-- > 0;) {  // the first one last
      if (!Differs(ours[k].value, theirs[k].value, difference)) continue;
      difference.field = ours[k].name;
      differs = true;
    }
    if (!differs) continue;
    difference.what = BodyNames(*repeated.scene)[i];
    return difference;
  }
  return std::nullopt;
}

std::optional<Difference> FindWheel(const Frame& recorded, const Frame& repeated) {
  for (std::size_t i = 0; i < recorded.scene->robots.size(); ++i) {
    const WheelStates a = WheelsOf(recorded, i), b = WheelsOf(repeated, i);
    Difference difference = DifferenceAt(repeated, repeated.scene->robots[i].entry.name, "");
    for (std::size_t side = 0; side < 2; ++side) {
      const std::string name = side == 0 ? "left" : "right";
      difference.field = "wheel_angle_" + name + "_rad";
      if (Differs(a.angle_rad[side], b.angle_rad[side], difference)) return difference;
      difference.field = "wheel_speed_" + name + "_rad_s";
      if (Differs(a.speed_rad_s[side], b.speed_rad_s[side], difference)) return difference;
    }
    difference.field = "commanded";
    const auto actuator = static_cast<std::size_t>(recorded.scene->robots[i].first_actuator);
    if (Differs(int{recorded.commanded[actuator]}, int{repeated.commanded[actuator]}, difference))
      return difference;
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
    // Of two senders the one that comes first: the other list lacks its broadcast.
    if (a != nullptr && b != nullptr && (a->step != b->step || a->robot != b->robot)) {
      const bool ours = a->step != b->step ? a->step < b->step : a->robot < b->robot;
      (ours ? b : a) = nullptr;
    }
    const SentMessage& first = a != nullptr ? *a : *b;
    const std::vector<SceneRobot>& robots = frame.scene->robots;
    Difference difference = DifferenceAt(
        frame, first.robot < robots.size() ? robots[first.robot].entry.name : "no robot", "broadcast");
    difference.recorded = Worded(a);
    difference.repeated = Worded(b);
    difference.exact = true;
    return difference;
  }
  return std::nullopt;
}

}  // namespace

Difference DifferenceAt(const Frame& frame, std::string what, std::string field) {
  Difference difference;
  difference.step = difference.value_step = frame.step;
  difference.time = frame.time;
  difference.what = std::move(what);
  difference.field = std::move(field);
  return difference;
}

std::optional<Difference> FindSetpoint(std::span<const WheelSpeeds> recorded, const Frame& repeated,
                                       std::span<const std::uint8_t> computed) {
  for (std::size_t i = 0; i < recorded.size(); ++i) {
    if (!computed.empty() && computed[i] == 0) continue;
    const WheelSpeeds ours = WheelSetpoints(repeated, i);
    if (SameBits(recorded[i][0], ours[0]) && SameBits(recorded[i][1], ours[1])) continue;
    Difference difference = DifferenceAt(repeated, repeated.scene->robots[i].entry.name, "");
    for (std::size_t side = 0; side < 2; ++side) {
      difference.field = kSetpointFields[side];
      if (Differs(recorded[i][side], ours[side], difference)) return difference;
    }
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
    const std::vector<Field> fields = FieldsOf(ours);
    for (std::size_t k = 0; k < 7; ++k) {
      const bool place = k < 3;
      const double told = place ? recorded[i].p_WB[static_cast<Eigen::Index>(k)] : turn[k - 3];
      const double rounding = place ? 0.501 * unit_m : kTurnRounding;
      if (std::abs(told - fields[k].value) <= rounding) continue;
      Difference difference = DifferenceAt(repeated, BodyNames(*repeated.scene)[i], fields[k].name);
      difference.recorded = place ? fmt::format("{:.6f}", told) : fmt::format("{:.7f}", told);
      difference.repeated = Exact(fields[k].value);
      return difference;
    }
  }
  return std::nullopt;
}

std::optional<Difference> FindExact(const Frame& recorded, const Frame& repeated) {
  std::vector<WheelSpeeds> setpoints;
  for (std::size_t i = 0; i < recorded.scene->robots.size(); ++i)
    setpoints.push_back(WheelSetpoints(recorded, i));
  if (auto found = FindSetpoint(setpoints, repeated)) return found;
  if (auto found = FindBody(recorded, repeated)) return found;
  Difference difference = DifferenceAt(repeated, "solver", "seed");
  if (Differs(recorded.solver_seed, repeated.solver_seed, difference)) return difference;
  difference.what = "run";
  difference.field = "time_ns";
  if (Differs(recorded.time, repeated.time, difference)) return difference;
  difference.field = "seed";
  if (Differs(recorded.seed, repeated.seed, difference)) return difference;
  if (auto found = FindWheel(recorded, repeated)) return found;
  return FindMessage(recorded.messages, repeated.messages, repeated);
}

std::string CommandsOf(const RecordedStep& step, const Scene& scene) {
  constexpr std::size_t kNamed = 5;
  std::string text;
  for (std::size_t i = 0; i < std::min(step.commands.size(), kNamed); ++i) {
    const CommandRecord& command = step.commands[i];
    if (command.robot >= scene.robots.size()) continue;
    text += fmt::format("{}{} ({:.17g}, {:.17g} rad/s{})", text.empty() ? "" : ", ",
                        scene.robots[command.robot].entry.name, command.setpoint[0], command.setpoint[1],
                        command.by_client ? "" : ", not by a client");
  }
  if (text.empty()) return {};
  const std::size_t more = step.commands.size() - std::min(step.commands.size(), kNamed);
  if (more > 0) text += fmt::format(" and {} more", more);
  return "set-points that came in force with step " + std::to_string(step.step) + ": " + text;
}

}  // namespace coopdyn
