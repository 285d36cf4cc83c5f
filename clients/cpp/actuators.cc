// SPDX-License-Identifier: MIT
#include "clients/cpp/actuators.h"

#include <utility>

#include "clients/cpp/session.h"
#include "clients/cpp/words.h"
#include "protocol/command_ids.h"

namespace coopdyn::client {

Muscles::Muscles(std::shared_ptr<Session> session, std::shared_ptr<RobotLink> link)
    : Parts(std::move(session), std::move(link), "muscle", command::kGetMuscleLimits) {
  link_->last = Command{command::kSetActivations, std::vector<double>(names_.size())};
}

void Muscles::set_activations(const std::vector<double>& activations, const Which& muscles) {
  Actuate(command::kSetActivations, activations, muscles, "an activation");
}

MuscleReading Muscles::get(const Which& muscles) {
  auto c = Columns(command::kGetMuscles, 6, muscles);
  return {std::move(c[0]), std::move(c[1]), std::move(c[2]),
          std::move(c[3]), std::move(c[4]), std::move(c[5])};
}

MuscleLimits Muscles::get_limits() {
  auto c = Columns(command::kGetMuscleLimits, 3, {});
  return {std::move(c[0]), std::move(c[1]), std::move(c[2])};
}

Thrusters::Thrusters(std::shared_ptr<Session> session, std::shared_ptr<RobotLink> link)
    : Parts(std::move(session), std::move(link), "thruster", command::kGetThrusterLimits) {
  link_->last = Command{command::kSetThrusts, std::vector<double>(names_.size())};
}

void Thrusters::set_thrusts(const std::vector<double>& thrusts, const Which& thrusters) {
  Actuate(command::kSetThrusts, thrusts, thrusters, "a thrust");
}

ThrusterReading Thrusters::get(const Which& thrusters) {
  auto c = Columns(command::kGetThrusts, 2, thrusters);
  return {std::move(c[0]), std::move(c[1])};
}

ThrusterLimits Thrusters::get_limits() {
  return {std::move(Columns(command::kGetThrusterLimits, 1, {})[0])};
}

Channel::Channel(std::shared_ptr<RobotLink> link) : link_(std::move(link)) {
  const Message reply = link_->Read(link_->actuator, {command::kGetChannel});
  const std::vector<std::string> names = Words(reply.text);
  Require(reply, 3, 6 * names.size());
  const auto count = static_cast<std::size_t>(reply.params[0]);
  steps_ = reply.params[2];
  const double* d = reply.data.data();
  for (std::size_t k = 0; k < names.size(); ++k, d += 6)
    (k < count ? motors_ : values_).push_back({names[k], d[0], d[1], d[2], d[3], d[4] != 0});
}

std::vector<std::int32_t> Channel::Ids(const Which& which, const std::vector<Mapped>& mapped,
                                       const char* one) const {
  std::vector<std::string> names;
  for (const Mapped& part : mapped) names.push_back(part.name);
  return SelectIds(which, names, one, link_->label());
}

void Channel::set(const std::vector<double>& values, const Which& motors) {
  for (const double value : values) Finite(value, "a value");
  const std::vector<std::int32_t> ids = Ids(motors, motors_, "motor");
  const std::vector<double> spread = Broadcast(values, ids.size(), "motor");
  if (ids.size() < motors_.size() && sent_.empty())
    throw Error(kNotPossible, "set all " + std::to_string(motors_.size()) +
                                  " motors first: c.set({…}), then one by its name");
  std::vector<double> told = sent_;
  told.resize(motors_.size());
  for (std::size_t i = 0; i < ids.size(); ++i) told[static_cast<std::size_t>(ids[i]) - 1] = spread[i];
  link_->Actuate(command::kSetMotors, told, {1});  // for one step; the values then hold
  sent_ = std::move(told);
}

std::vector<double> Channel::get(const Which& values) {
  const std::vector<std::int32_t> ids = Ids(values, values_, "value");
  const Message reply = link_->Read(link_->actuator, {command::kGetValues});
  Require(reply, 0, values_.size());
  std::vector<double> chosen;
  for (const std::int32_t id : ids) chosen.push_back(reply.data[static_cast<std::size_t>(id) - 1]);
  return chosen;
}

bool Channel::aborted() {
  return link_->Read(link_->actuator, {command::kGetValues}).text == "aborted";
}

}  // namespace coopdyn::client
