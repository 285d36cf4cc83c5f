// SPDX-License-Identifier: MIT
#include "clients/cpp/joints.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "clients/cpp/session.h"
#include "clients/cpp/words.h"
#include "protocol/command_ids.h"

namespace coopdyn::client {
namespace {

constexpr std::array kJointModes = {"idle", "position", "direct", "velocity", "effort", "pwm"};

}  // namespace

Joints::Joints(std::shared_ptr<Session> session, std::shared_ptr<RobotLink> link)
    : Parts(std::move(session), std::move(link), "joint", command::kGetJointLimits) {}

void Joints::set_positions(const std::vector<double>& positions, const WhichJoints& joints) {
  Actuate(command::kSetPositions, positions, joints, "a position");
}

void Joints::set_positions_direct(const std::vector<double>& positions, const WhichJoints& joints) {
  Actuate(command::kSetPositionsDirect, positions, joints, "a position");
}

void Joints::set_velocities(const std::vector<double>& velocities, const WhichJoints& joints) {
  Actuate(command::kSetVelocities, velocities, joints, "a velocity");
}

void Joints::set_efforts(const std::vector<double>& efforts, const WhichJoints& joints) {
  Actuate(command::kSetEfforts, efforts, joints, "an effort");
}

void Joints::set_pwm(const std::vector<double>& duties, const WhichJoints& joints) {
  Actuate(command::kSetPwm, duties, joints, "a duty");
}

void Joints::set_modes(const std::vector<std::string>& modes, const WhichJoints& joints) {
  std::vector<double> numbers;
  for (const std::string& mode : modes) {
    const auto found = std::find(kJointModes.begin(), kJointModes.end(), mode);
    if (found == kJointModes.end())
      throw Error(4, "there is no mode '" + mode +
                         "'; write one of: " + ListOf({kJointModes.begin(), kJointModes.end()}));
    numbers.push_back(static_cast<double>(found - kJointModes.begin()));
  }
  Actuate(command::kSetModes, numbers, joints, "a mode");
}

void Joints::hold(const WhichJoints& joints) {
  link_->Actuate(command::kHold, {}, Ids(joints));
}

void Joints::Tune(std::int32_t command, const std::vector<const std::vector<double>*>& columns,
                  const WhichJoints& joints) {
  session_->RequireDriving();
  Request request{.command = command, .params = Ids(joints)};
  const std::size_t count = request.params.size();
  request.data.resize(count * columns.size());
  for (std::size_t c = 0; c < columns.size(); ++c) {
    const std::vector<double> column = Broadcast(*columns[c], count, one_);
    for (std::size_t i = 0; i < count; ++i) request.data[i * columns.size() + c] = column[i];
  }
  link_->Read(link_->actuator, std::move(request));
}

void Joints::set_compliance(const std::vector<double>& k, const std::vector<double>& d,
                            const std::vector<double>& offset, const WhichJoints& joints) {
  for (const double value : k) {
    if (std::isnan(value) || value < 0) throw Error(4, "a k [N m/rad] must be 0 or more, or inf: a servo");
  }
  for (const double value : d) Finite(value, "a d [N m s/rad]");
  for (const double value : offset) Finite(value, "an offset [N m]");
  Tune(command::kSetCompliance, {&k, &d, &offset}, joints);
}

void Joints::set_profile(const std::vector<double>& speed, const std::vector<double>& acceleration,
                         const WhichJoints& joints) {
  for (const double value : speed) Finite(value, "a speed [rad/s]");
  for (const double value : acceleration) Finite(value, "an acceleration [rad/s2]");
  Tune(command::kSetProfile, {&speed, &acceleration}, joints);
}

void Joints::set_gains(const std::vector<double>& p, const std::vector<double>& i,
                       const std::vector<double>& d, const WhichJoints& joints) {
  for (const double value : p) Finite(value, "a p [1/s]");
  for (const double value : i) Finite(value, "an i [1/s2]");
  for (const double value : d) Finite(value, "a d");
  Tune(command::kSetGains, {&p, &i, &d}, joints);
}

JointReading Joints::get(const WhichJoints& joints) {
  auto c = Columns(command::kGetJoints, 3, joints);
  return {std::move(c[0]), std::move(c[1]), std::move(c[2])};
}

std::vector<std::string> Joints::get_modes(const WhichJoints& joints) {
  std::vector<std::string> modes;
  for (const std::int32_t mode : link_->Read(link_->actuator, {command::kGetModes, Ids(joints)}).params) {
    const auto index = static_cast<std::size_t>(mode);
    modes.push_back(index < kJointModes.size() ? kJointModes[index] : std::to_string(mode));
  }
  return modes;
}

Compliance Joints::get_compliance(const WhichJoints& joints) {
  auto c = Columns(command::kGetCompliance, 3, joints);
  return {std::move(c[0]), std::move(c[1]), std::move(c[2])};
}

Profile Joints::get_profile(const WhichJoints& joints) {
  auto c = Columns(command::kGetProfile, 2, joints);
  return {std::move(c[0]), std::move(c[1])};
}

Gains Joints::get_gains(const WhichJoints& joints) {
  auto c = Columns(command::kGetGains, 3, joints);
  return {std::move(c[0]), std::move(c[1]), std::move(c[2])};
}

JointLimits Joints::get_limits(const WhichJoints& joints) {
  auto c = Columns(command::kGetJointLimits, 4, joints);
  return {std::move(c[0]), std::move(c[1]), std::move(c[2]), std::move(c[3])};
}

Motion Joints::get_motion(const WhichJoints& joints) {
  const Message reply = link_->Read(link_->actuator, {command::kGetMotion, Ids(joints)});
  Require(reply, 0, 0);
  Motion motion;
  for (const std::int32_t arrived : reply.params) motion.arrived.push_back(arrived != 0);
  motion.target.assign(reply.data.begin(), reply.data.end() - 2);
  return motion;
}

bool Joints::arrived(const WhichJoints& joints) {
  if (link_->kept) return false;
  const Motion motion = get_motion(joints);
  return session_->steps() > link_->commanded_at &&
         std::all_of(motion.arrived.begin(), motion.arrived.end(), [](bool there) { return there; });
}

std::vector<double> Joints::get_references(const WhichJoints& joints) {
  return std::move(Columns(command::kGetReferences, 1, joints)[0]);
}

DriveTrains Joints::get_drive_trains(const WhichJoints& joints) {
  auto c = Columns(command::kGetDriveTrains, 4, joints);
  return {std::move(c[0]), std::move(c[1]), std::move(c[2]), std::move(c[3])};
}

const Chain& Joints::get_chain() {
  if (chain_) return *chain_;
  const Message reply = link_->Read(link_->actuator, {command::kGetChain});
  const std::size_t count = reply.params.size() / 2;
  Require(reply, 0, 6 * count + 7);
  const JointLimits limits = get_limits();
  const double* d = reply.data.data();
  std::vector<ChainJoint> joints;
  std::vector<std::size_t> indices;
  for (std::size_t k = 0; k < count; ++k, d += 6) {
    const auto index = static_cast<std::size_t>(reply.params[2 * k]) - 1;
    if (index >= names_.size()) throw Error(7, "the chain names a joint that is not there");
    indices.push_back(index);
    joints.push_back({{d[0], d[1], d[2]},
                      {d[3], d[4], d[5]},
                      reply.params[2 * k + 1] == 1,
                      limits.lower[index],
                      limits.upper[index]});
  }
  Eigen::Isometry3d tool = Eigen::Isometry3d::Identity();
  tool.translate(Eigen::Vector3d(d[0], d[1], d[2]));
  tool.rotate(Eigen::Quaterniond(d[3], d[4], d[5], d[6]).normalized());
  chain_joints_ = std::move(indices);
  return chain_.emplace(std::move(joints), tool);
}

std::vector<double> Joints::Posture(const std::vector<double>& q) {
  if (q.empty()) return get().position;
  if (q.size() != names_.size())
    throw Error(3, "a posture has a value for each of the " + std::to_string(names_.size()) +
                       " joints: " + ListOf(names_));
  return q;
}

std::vector<double> Joints::OfChain(const std::vector<double>& q) {
  std::vector<double> values;
  for (const std::size_t index : chain_joints_) values.push_back(q[index]);
  return values;
}

Eigen::Isometry3d Joints::forward() {
  return forward(get().position);
}

Eigen::Isometry3d Joints::forward(const std::vector<double>& q) {
  const Chain& chain = get_chain();
  return chain.forward(OfChain(Posture(q)));
}

template <class Target>
std::vector<double> Joints::Inverse(const Target& target, const std::vector<double>& q0) {
  const Chain& chain = get_chain();
  std::vector<double> q = Posture(q0);
  const std::vector<double> found = chain.inverse(target, OfChain(q));
  for (std::size_t k = 0; k < found.size(); ++k) q[chain_joints_[k]] = found[k];
  return q;
}

std::vector<double> Joints::inverse(const Eigen::Isometry3d& pose, const std::vector<double>& q0) {
  return Inverse(pose, q0);
}

std::vector<double> Joints::inverse(const Eigen::Vector3d& position, const std::vector<double>& q0) {
  return Inverse(position, q0);
}

}  // namespace coopdyn::client
