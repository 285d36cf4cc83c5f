// SPDX-License-Identifier: MIT
// Moves an arm's tool to the corners of a square in turn. Forward kinematics is the product of exponentials
// of the joints (Lynch and Park, Modern Robotics, eq. 4.14); inverse kinematics is damped least squares, one
// small step of the tool at a time. Works for any serial arm: the joints with position modes, from base to
// tool. The tool lies on the last joint's axis, at that joint's origin.
#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "cpp_controller.h"

namespace {

using Vector = std::array<double, 3>;

Vector Cross(const Vector& a, const Vector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
double Dot(const Vector& a, const Vector& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
Vector Sum(const Vector& a, const Vector& b, double times = 1) {
  return {a[0] + times * b[0], a[1] + times * b[1], a[2] + times * b[2]};
}
/// `v` rotated about a unit axis (Rodrigues).
Vector Turned(const Vector& v, const Vector& axis, double angle) {
  const double c = coopdyn_cos(angle), s = coopdyn_sin(angle), along = (1 - c) * Dot(axis, v);
  const Vector across = Cross(axis, v);
  return {c * v[0] + s * across[0] + along * axis[0], c * v[1] + s * across[1] + along * axis[1],
          c * v[2] + s * across[2] + along * axis[2]};
}

class Reach {
 public:
  static constexpr size_t kMost = 16;  // joints
  struct State {
    double q[kMost];  // wanted joint positions
    double there_s;   // time since the tool reached the corner
    uint32_t corner, started, reached;
  };
  State state{};

  static const coopdyn_description* Describe() {
    static const coopdyn_option options[] = {
        {"x", "of the square's middle in the robot's frame, m", 0.45, -10, 10},
        {"y", "likewise", 0, -10, 10},
        {"z", "likewise", 0.45, -10, 10},
        {"size", "of the square's side, upright across the robot's x, m", 0.2, 0, 10},
        {"speed", "of the tool, m/s", 0.25, 0.001, 10},
        {"stay", "at each corner, s", 0.5, 0, 1000},
        {"near", "so near to a corner it is there, m", 0.001, 1e-6, 1},
    };
    static const coopdyn_description description = {"moves an arm's tool to the corners of a square",
                                                    COOPDYN_CHANNELS | COOPDYN_SETPOINTS, sizeof(State), 7,
                                                    options};
    return &description;
  }

  Reach(const coopdyn_robot& robot, const double* options)
      : robot_(robot),
        middle_m_{options[0], options[1], options[2]},
        side_m_(options[3]),
        speed_m_s_(options[4]),
        stay_s_(options[5]),
        near_m_(options[6]) {
    for (size_t i = 0; i < robot.channel_count; ++i) {
      if ((robot.channels[i].modes >> COOPDYN_DIRECT & 1) != 0) joints_.push_back(i);
    }
    if (joints_.empty() || joints_.size() > kMost) {
      throw std::runtime_error("the robot needs an arm of 1 to 16 joints that take positions");
    }
  }

  void Reset(uint64_t /*seed*/) { state = {}; }

  void Step(const coopdyn_readings& readings, coopdyn_command& command) {
    if (state.started == 0) {
      for (size_t i = 0; i < joints_.size(); ++i) state.q[i] = readings.channels[joints_[i]].position;
      state.started = 1;
    }
    constexpr std::array<std::array<double, 2>, 4> kCorners = {{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}};
    const auto [right, up] = kCorners[state.corner];
    const Vector goal = Sum(middle_m_, {0, -right * side_m_ / 2, up * side_m_ / 2});
    Vector way = Sum(goal, Tool(), -1);
    const double far_m = std::sqrt(Dot(way, way));
    if (far_m < near_m_) {
      if (state.there_s == 0) ++state.reached;
      state.there_s += readings.step_s;
      if (state.there_s >= stay_s_) {
        state.corner = (state.corner + 1) % kCorners.size();
        state.there_s = 0;
      }
    }
    const double most_m = speed_m_s_ * readings.step_s;
    if (far_m > most_m) way = Sum({0, 0, 0}, way, most_m / far_m);
    Move(way, readings.step_s);
    for (size_t i = 0; i < joints_.size(); ++i) {
      command.setpoints[joints_[i]] = {COOPDYN_DIRECT, state.q[i]};
    }
  }

 private:
  const coopdyn_joint& Joint(size_t i) const { return robot_.channels[joints_[i]]; }
  static Vector Of(const double (&values)[3]) { return {values[0], values[1], values[2]}; }

  /// Moves a point carried by the first `count` joints.
  Vector Carried(Vector point, size_t count) const {
    for (size_t i = count; i-- > 0;) {
      const Vector anchor = Of(Joint(i).point_m), axis = Of(Joint(i).axis);
      point = Joint(i).slides != 0 ? Sum(point, axis, state.q[i])
                                   : Sum(anchor, Turned(Sum(point, anchor, -1), axis, state.q[i]));
    }
    return point;
  }
  Vector Directed(Vector direction, size_t count) const {
    for (size_t i = count; i-- > 0;) {
      if (Joint(i).slides == 0) direction = Turned(direction, Of(Joint(i).axis), state.q[i]);
    }
    return direction;
  }
  Vector Tool() const { return Carried(Of(Joint(joints_.size() - 1).point_m), joints_.size()); }

  /// Moves the tool by `way`, as far as the joints' speeds and stops allow.
  void Move(const Vector& way, double dt_s) {
    constexpr double kDamping_m = 0.02;
    const Vector tool = Tool();
    std::array<Vector, kMost> columns{};
    std::array<Vector, 3> A{};  // J Jᵀ, damped
    for (size_t k = 0; k < 3; ++k) A[k][k] = kDamping_m * kDamping_m;
    for (size_t i = 0; i < joints_.size(); ++i) {
      const Vector axis = Directed(Of(Joint(i).axis), i);
      columns[i] = Joint(i).slides != 0 ? axis : Cross(axis, Sum(tool, Carried(Of(Joint(i).point_m), i), -1));
      for (size_t r = 0; r < 3; ++r) {
        for (size_t c = 0; c < 3; ++c) A[r][c] += columns[i][r] * columns[i][c];
      }
    }
    // A y = way by Cramer's rule; A is symmetric.
    const Vector c0 = Cross(A[1], A[2]), c1 = Cross(A[2], A[0]), c2 = Cross(A[0], A[1]);
    const double det = Dot(A[0], c0);
    const Vector y = {Dot({c0[0], c1[0], c2[0]}, way) / det, Dot({c0[1], c1[1], c2[1]}, way) / det,
                      Dot({c0[2], c1[2], c2[2]}, way) / det};
    double share = 1;
    std::array<double, kMost> turn{};
    for (size_t i = 0; i < joints_.size(); ++i) {
      turn[i] = Dot(columns[i], y);
      const double most = Joint(i).max_velocity * dt_s;
      if (std::abs(turn[i]) > most) share = std::min(share, most / std::abs(turn[i]));
    }
    for (size_t i = 0; i < joints_.size(); ++i) {
      state.q[i] = std::clamp(state.q[i] + share * turn[i], Joint(i).lower, Joint(i).upper);
    }
  }

  const coopdyn_robot& robot_;
  const Vector middle_m_;
  const double side_m_, speed_m_s_, stay_s_, near_m_;
  std::vector<size_t> joints_;
};

}  // namespace

extern "C" const coopdyn_controller* coopdyn_controller_entry() {
  return coopdyn::Entry<Reach>();
}
