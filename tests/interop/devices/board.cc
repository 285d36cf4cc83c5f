// SPDX-License-Identifier: MIT
#include "board.h"

#include <yarp/os/Property.h>
#include <yarp/os/Vocab.h>

#include <cmath>
#include <cstddef>

#include "checks.h"

namespace coopdyn {
namespace {

constexpr bool kIs4 = YARP_VERSION_MAJOR >= 4;

std::string WordOf(int code) {
  return yarp::os::Vocab32::decode(code);
}

int CodeOf(const std::string& word) {
  return yarp::os::Vocab32::encode(word);
}

}  // namespace

bool Board::Open(const std::string& remote, const std::string& local) {
  yarp::os::Property options;
  options.put("device", kIs4 ? "controlBoard_nwc_yarp" : "remote_controlboard");
  options.put("remote", remote);
  options.put("local", local);
  if (!driver_.open(options)) return false;
  const bool all = driver_.view(encoders) && driver_.view(motors) && driver_.view(info) &&
                   driver_.view(limits) && driver_.view(modes) && driver_.view(position) &&
                   driver_.view(direct) && driver_.view(velocity) && driver_.view(torque) &&
                   driver_.view(impedance) && driver_.view(interaction) && driver_.view(pid) &&
                   driver_.view(pwm) && driver_.view(current) && driver_.view(timed);
  if (!all) return false;
#if YARP_VERSION_MAJOR >= 4
  std::size_t count = 0;
  const bool told = bool(encoders->getAxes(count));
  axes_ = static_cast<int>(count);
#else
  const bool told = encoders->getAxes(&axes_);
#endif
  // The client has no data until the first state has arrived.
  return told && axes_ > 0 && WaitFor([this] { return Positions().has_value(); });
}

std::optional<std::vector<double>> Board::Positions() {
  std::vector<double> values(axes_);
  return encoders->getEncoders(values.data()) ? std::optional(values) : std::nullopt;
}

std::optional<std::vector<double>> Board::Speeds() {
  std::vector<double> values(axes_);
  return encoders->getEncoderSpeeds(values.data()) ? std::optional(values) : std::nullopt;
}

double Board::Position(int joint) {
  double value = NAN;
  return encoders->getEncoder(joint, &value) ? value : NAN;
}

double Board::Speed(int joint) {
  double value = NAN;
  return encoders->getEncoderSpeed(joint, &value) ? value : NAN;
}

double Board::Stamp(int joint) {
  double value = NAN, stamp = NAN;
  return encoders->getEncoderTimed(joint, &value, &stamp) ? stamp : NAN;
}

double Board::MeanSpeed(int joint) {
  double first = NAN, first_s = NAN, last = NAN, last_s = NAN;
  if (!encoders->getEncoderTimed(joint, &first, &first_s)) return NAN;
  const bool came =
      WaitFor([&] { return !encoders->getEncoderTimed(joint, &last, &last_s) || last_s >= first_s + 0.1; });
  return came ? (last - first) / (last_s - first_s) : NAN;
}

bool Board::Arrive() {
  return WaitFor([this] { return Done().value_or(false); });
}

bool Board::Shows(int joint, const std::string& mode) {
  return WaitFor([&] { return Mode(joint) == mode; });
}

bool Board::SetInteraction(int joint, const std::string& mode) {
  return bool(
      interaction->setInteractionMode(joint, static_cast<yarp::dev::InteractionModeEnum>(CodeOf(mode))));
}

#if YARP_VERSION_MAJOR >= 4

std::optional<bool> Board::Done() {
  bool done = false;
  return position->checkMotionDone(done) ? std::optional(done) : std::nullopt;
}

std::optional<bool> Board::Done(int joint) {
  bool done = false;
  return position->checkMotionDone(joint, done) ? std::optional(done) : std::nullopt;
}

std::optional<std::string> Board::Mode(int joint) {
  yarp::dev::ControlModeEnum mode{};
  if (!modes->getControlMode(joint, mode)) return {};
  return WordOf(static_cast<int>(mode));
}

bool Board::SetMode(int joint, const std::string& mode) {
  return bool(modes->setControlMode(joint, static_cast<yarp::dev::SelectableControlModeEnum>(CodeOf(mode))));
}

bool Board::SetModes(const std::string& mode) {
  const auto code = static_cast<yarp::dev::SelectableControlModeEnum>(CodeOf(mode));
  return bool(modes->setControlModes(std::vector(axes_, code)));
}

bool Board::SetWaySpeeds(const std::vector<double>& speeds) {
  return bool(position->setTrajSpeeds(speeds.data()));
}

std::optional<std::vector<double>> Board::WaySpeeds() {
  std::vector<double> values(axes_);
  return position->getTrajSpeeds(values.data()) ? std::optional(values) : std::nullopt;
}

bool Board::SetWayAccelerations(const std::vector<double>& accelerations) {
  return bool(position->setTrajAccelerations(accelerations.data()));
}

std::optional<std::vector<double>> Board::WayAccelerations() {
  std::vector<double> values(axes_);
  return position->getTrajAccelerations(values.data()) ? std::optional(values) : std::nullopt;
}

std::optional<double> Board::VelocityReference(int joint) {
  double value = NAN;
  return velocity->getTargetVelocity(joint, &value) ? std::optional(value) : std::nullopt;
}

bool Board::Limits(int joint, double& lower, double& upper) {
  return bool(limits->getPosLimits(joint, &lower, &upper));
}

bool Board::SetLimits(int joint, double lower, double upper) {
  return bool(limits->setPosLimits(joint, lower, upper));
}

std::optional<std::string> Board::Interaction(int joint) {
  yarp::dev::InteractionModeEnum mode{};
  if (!interaction->getInteractionMode(joint, mode)) return {};
  return WordOf(static_cast<int>(mode));
}

std::optional<bool> Board::PidEnabled(int joint) {
  bool enabled = false;
  if (!pid->isPidEnabled(yarp::dev::PidControlTypeEnum::VOCAB_PIDTYPE_POSITION, joint, enabled)) return {};
  return enabled;
}

#else

std::optional<bool> Board::Done() {
  bool done = false;
  return position->checkMotionDone(&done) ? std::optional(done) : std::nullopt;
}

std::optional<bool> Board::Done(int joint) {
  bool done = false;
  return position->checkMotionDone(joint, &done) ? std::optional(done) : std::nullopt;
}

std::optional<std::string> Board::Mode(int joint) {
  int mode = 0;
  return modes->getControlMode(joint, &mode) ? std::optional(WordOf(mode)) : std::nullopt;
}

bool Board::SetMode(int joint, const std::string& mode) {
  return modes->setControlMode(joint, CodeOf(mode));
}

bool Board::SetModes(const std::string& mode) {
  std::vector<int> codes(axes_, CodeOf(mode));
  return modes->setControlModes(codes.data());
}

bool Board::SetWaySpeeds(const std::vector<double>& speeds) {
  return position->setRefSpeeds(speeds.data());
}

std::optional<std::vector<double>> Board::WaySpeeds() {
  std::vector<double> values(axes_);
  return position->getRefSpeeds(values.data()) ? std::optional(values) : std::nullopt;
}

bool Board::SetWayAccelerations(const std::vector<double>& accelerations) {
  return position->setRefAccelerations(accelerations.data());
}

std::optional<std::vector<double>> Board::WayAccelerations() {
  std::vector<double> values(axes_);
  return position->getRefAccelerations(values.data()) ? std::optional(values) : std::nullopt;
}

std::optional<double> Board::VelocityReference(int joint) {
  double value = NAN;
  return velocity->getRefVelocity(joint, &value) ? std::optional(value) : std::nullopt;
}

bool Board::Limits(int joint, double& lower, double& upper) {
  return limits->getLimits(joint, &lower, &upper);
}

bool Board::SetLimits(int joint, double lower, double upper) {
  return limits->setLimits(joint, lower, upper);
}

std::optional<std::string> Board::Interaction(int joint) {
  yarp::dev::InteractionModeEnum mode = yarp::dev::VOCAB_IM_UNKNOWN;
  if (!interaction->getInteractionMode(joint, &mode)) return {};
  return WordOf(static_cast<int>(mode));
}

std::optional<bool> Board::PidEnabled(int joint) {
  bool enabled = false;
  if (!pid->isPidEnabled(yarp::dev::VOCAB_PIDTYPE_POSITION, joint, &enabled)) return {};
  return enabled;
}

#endif

}  // namespace coopdyn
