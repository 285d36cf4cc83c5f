// SPDX-License-Identifier: MIT
// coopdyn's own sensor elements: what all kinds have in common.
#include "server/model/sdf_sensors.h"

#include <tinyxml2.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <utility>

#include "server/model/values.h"

namespace coopdyn {

namespace {

using tinyxml2::XMLElement;

/// A kind of sensor in model files.
struct Words {
  std::string_view type;  // of its module
  SensorElement element;
  SensorKind (*read)(const SensorSource& source);
  SensorKind usual;  // default without an element
};

template <typename Kind>
SensorKind ReadKind(const SensorSource& source) {
  Kind sensor;
  if constexpr (requires { sensor.Read(source); }) sensor.Read(source);
  return sensor;
}

template <typename... Kinds>
std::array<Words, sizeof...(Kinds)> TableOf(const std::variant<Kinds...>& /*any*/) {
  return {Words{Kinds::kType, Kinds::kElement, ReadKind<Kinds>, Kinds()}...};
}

/// The kinds in the order of SensorKind.
std::span<const Words> Table() {
  static const auto kTable = TableOf(SensorKind());
  return kTable;
}

void ReadTiming(XmlAttributes& attributes, SensorTiming& timing) {
  if (auto v = attributes.Number("rate", 0, kMaxSensorRate_hz)) timing.rate_hz = *v;
  if (auto v = attributes.Number("delay", 0, kMaxSensorDelay_s)) timing.delay_s = *v;
}

}  // namespace

std::optional<std::size_t> SensorSource::FindLink(XmlAttributes& from, const std::string& name) const {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < robot.frames.size(); ++i) {
    if (robot.frames[i].name == name) return i;
    names.push_back(robot.frames[i].name);
  }
  from.Error("there is no link '" + name + "'" + DidYouMean(name, names));
  return std::nullopt;
}

Mount SensorSource::ReadMount(XmlAttributes& from) const {
  Pose X_FS;
  if (const auto pose = from.Numbers("pose", 6)) {
    const std::vector<double>& v = *pose;
    if (std::ranges::any_of(v, [](double x) { return std::abs(x) > kMaxSensorLength_m; }))
      from.Error("the pose is too far away");
    X_FS = {Vector3(v[0], v[1], v[2]), FromRollPitchYaw(v[3], v[4], v[5])};
  }
  const std::string name = from.Text("link").value_or(robot.links.empty() ? "" : robot.links.front().name);
  const std::optional<std::size_t> link = FindLink(from, name);
  return link ? MountOn(robot, *link, X_FS) : Mount{};
}

void SensorSource::ForEachChild(
    std::initializer_list<std::string_view> names,
    const std::function<void(XmlAttributes& child, std::string_view name)>& read) const {
  has_read_children = true;
  const std::vector<std::string> known(names.begin(), names.end());
  for (const XMLElement* child = element.FirstChildElement(); child != nullptr;
       child = child->NextSiblingElement()) {
    XmlAttributes own(*child, file, diagnostics);
    if (std::ranges::find(known, child->Name()) == known.end()) {
      diagnostics.Error(own.where(), std::string("unknown element <") + child->Name() + ">" +
                                         DidYouMean(child->Name(), known));
      continue;
    }
    read(own, child->Name());
    own.Finish();
  }
}

void ReadNoise(XmlAttributes& attributes, const std::string& prefix, ValueNoise& noise) {
  constexpr double kMost = 1e9;
  if (auto v = attributes.Number(prefix + "noise_stddev", 0, kMost)) noise.stddev = *v;
  if (auto v = attributes.Number(prefix + "noise_uniform", 0, kMost)) noise.uniform = *v;
  if (auto v = attributes.Number(prefix + "bias_mean", -kMost, kMost)) noise.bias_mean = *v;
  if (auto v = attributes.Number(prefix + "bias_stddev", 0, kMost)) noise.bias_stddev = *v;
  if (auto v = attributes.Number(prefix + "resolution", 0, kMost)) noise.resolution = *v;
}

Mount MountOn(const RobotModel& robot, std::size_t frame, const Pose& X_FS) {
  const FrameModel& on = robot.frames[frame];
  return {on.link, robot.links[static_cast<std::size_t>(on.link)].X_RL.Inverse() * on.X_RF * X_FS};
}

std::vector<std::string> SensorReader::Elements() {
  std::vector<std::string> names;
  for (const Words& words : Table()) {
    if (!words.element.name.empty()) names.emplace_back(words.element.name);
  }
  return names;
}

bool SensorReader::Read(const XMLElement& element) {
  const auto words = std::find_if(Table().begin(), Table().end(), [&element](const Words& one) {
    return one.element.name == element.Name();
  });
  if (words == Table().end()) return false;
  XmlAttributes attributes(element, file_, diagnostics_);
  const std::string name = attributes.Text("name").value_or("");
  SensorTiming timing;
  const SensorSource source{element, attributes, file_, robot_, assembly_, diagnostics_, timing};
  SensorKind kind = words->read(source);
  if (words->element.has_timing) ReadTiming(attributes, timing);
  attributes.Finish();
  if (!source.has_read_children && (element.FirstChildElement() != nullptr || element.GetText() != nullptr))
    attributes.Error("holds no elements and no text: write its values as attributes");
  for (const Described& other : described_) {
    if (other.kind.index() == kind.index() && other.name == name) {
      attributes.Error("stands here twice: keep one, or give each the name=\"…\" of its module");
    }
  }
  described_.push_back({name, std::move(kind), timing, attributes.where()});
  return true;
}

void SensorReader::AddModule(XmlAttributes& attributes, const std::string& type, const std::string& name) {
  const auto words =
      std::find_if(Table().begin(), Table().end(), [&type](const Words& one) { return one.type == type; });
  if (words == Table().end()) {
    std::vector<std::string> types = {"motors"};
    for (const Words& one : Table()) types.emplace_back(one.type);
    attributes.Error("unknown module type '" + type + "'" + DidYouMean(type, types));
    return;
  }
  Described* found = nullptr;
  for (Described& one : described_) {
    if (one.kind.index() != words->usual.index()) continue;
    if (one.name == name || (one.name.empty() && found == nullptr)) found = &one;
  }
  if (found == nullptr && !words->element.example.empty() && !diagnostics_.has_errors()) {
    attributes.Error("a module '" + type + "' needs " + std::string(words->element.example) +
                     ": write it above");
  }
  if (found != nullptr) found->used = true;
  robot_.AddSensor(name, found != nullptr ? found->kind : words->usual,
                   found != nullptr ? found->timing : SensorTiming());
}

void SensorReader::Finish() {
  for (const Described& one : described_) {
    if (one.used) continue;
    const Words& words = Table()[one.kind.index()];
    const std::string name = one.name.empty() ? "" : " name=\"" + one.name + "\"";
    diagnostics_.Error(one.where, "<" + std::string(words.element.name) +
                                      "> needs its module: write <coopdyn:module type=\"" +
                                      std::string(words.type) + "\"" + name + "/>");
  }
  for (SensorModel& sensor : robot_.sensors) {
    auto* const channel = std::get_if<ChannelModel>(&sensor.kind);
    if (channel != nullptr) Connect(*channel, robot_, file_, diagnostics_);
  }
}

}  // namespace coopdyn
