// SPDX-License-Identifier: MIT
// The sensors in a robot's SDF.
#include <tinyxml2.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <span>
#include <string_view>
#include <utility>

#include "server/model/sdf_parts.h"
#include "server/model/values.h"

namespace coopdyn {

namespace {

using tinyxml2::XMLElement;

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kMaxLength_m = 1e5;

/// What `<coopdyn:distance_sensors>` says for all its sectors, or one sector for itself.
struct SectorDefaults {
  std::optional<double> radius_m, height_m;
  double opening_rad = 0;
  int rays = 1;
  double max_range_m = 0;
  double noise_stddev_m = 0;
};

SectorDefaults ReadSectorAttributes(XmlAttributes& attributes, SectorDefaults values) {
  if (auto v = attributes.Number("radius", 0, kMaxLength_m)) values.radius_m = v;
  if (auto v = attributes.Number("height", 0, kMaxLength_m)) values.height_m = v;
  if (auto v = attributes.Number("opening_deg", 0, 360)) values.opening_rad = *v * kDegree;
  if (auto v = attributes.Integer("rays", 1, 1000)) values.rays = *v;
  if (auto v = attributes.Number("max_range", 1e-3, kMaxLength_m)) values.max_range_m = *v;
  if (auto v = attributes.Number("noise_stddev", 0, kMaxLength_m)) values.noise_stddev_m = *v;
  return values;
}

SectorModel ReadSector(XmlAttributes& attributes, const SectorDefaults& common) {
  const SectorDefaults values = ReadSectorAttributes(attributes, common);
  const std::optional<double> bearing_deg = attributes.Number("bearing_deg", -180, 180);
  const auto pose = attributes.Numbers("pose", 6);
  attributes.Finish();
  SectorModel sector;
  if (pose) {
    const std::vector<double>& v = *pose;
    for (const double x : v) {
      if (std::abs(x) > kMaxLength_m) attributes.Error("the pose is too far away");
    }
    sector.X_RS = {Vector3(v[0], v[1], v[2]), FromRollPitchYaw(v[3], v[4], v[5])};
    sector.bearing_rad = Heading(sector.X_RS.q);
    if (bearing_deg) attributes.Error("give either 'pose' or 'bearing_deg', not both");
  } else if (bearing_deg && values.radius_m && values.height_m) {
    sector.bearing_rad = WrapAngle(*bearing_deg * kDegree);
    const double b = sector.bearing_rad;
    sector.X_RS = {Vector3(*values.radius_m * std::cos(b), *values.radius_m * std::sin(b), *values.height_m),
                   FromRollPitchYaw(0, 0, b)};
  } else {
    attributes.Error(
        "needs 'bearing_deg' with 'radius' and 'height' (here or in <coopdyn:distance_sensors>), or 'pose'");
  }
  if (values.max_range_m <= 0)
    attributes.Error("needs 'max_range' in m, here or in <coopdyn:distance_sensors>");
  if (values.rays == 1 && values.opening_rad > 0) {
    attributes.Error("one ray cannot sample an opening: write rays=\"5\" or opening_deg=\"0\"");
  }
  sector.opening_rad = values.opening_rad;
  sector.rays = values.rays;
  sector.max_range_m = values.max_range_m;
  sector.noise_stddev_m = values.noise_stddev_m;
  return sector;
}

/// One element, and whom to tell what is wrong with it.
struct Source {
  const XMLElement& element;
  XmlAttributes& attributes;
  const std::string& file;
  const std::vector<LinkModel>& links;  // of the robot
  Diagnostics& diagnostics;
};

void ReadInto(DistanceModel& sensor, const Source& source) {
  const SectorDefaults common = ReadSectorAttributes(source.attributes, {});
  for (const XMLElement* child = source.element.FirstChildElement(); child != nullptr;
       child = child->NextSiblingElement()) {
    XmlAttributes attributes(*child, source.file, source.diagnostics);
    if (std::string_view(child->Name()) == "coopdyn:sector") {
      sensor.sectors.push_back(ReadSector(attributes, common));
    } else {
      source.diagnostics.Error(attributes.where(), std::string("unknown element <") + child->Name() +
                                                       ">; did you mean 'coopdyn:sector'?");
    }
  }
  if (sensor.sectors.empty())
    source.attributes.Error("write at least one <coopdyn:sector bearing_deg=\"…\"/>");
  std::stable_sort(sensor.sectors.begin(), sensor.sectors.end(),
                   [](const auto& a, const auto& b) { return a.bearing_rad < b.bearing_rad; });
}

/// Noise of distance and bearing, which two kinds have.
template <typename Kind>
void ReadSightNoise(Kind& sensor, XmlAttributes& attributes) {
  if (auto v = attributes.Number("distance_noise_stddev", 0, kMaxLength_m))
    sensor.distance_noise_stddev_m = *v;
  if (auto v = attributes.Number("bearing_noise_stddev_deg", 0, 180))
    sensor.bearing_noise_stddev_rad = *v * kDegree;
}

void ReadInto(TargetModel& sensor, const Source& source) {
  if (auto v = source.attributes.Number("max_range", 1e-3, kMaxLength_m)) sensor.max_range_m = *v;
  if (auto v = source.attributes.Flag("see_through")) sensor.see_through = *v;
  ReadSightNoise(sensor, source.attributes);
}

void ReadInto(PoseModel& /*sensor*/, const Source& /*source*/) {}

void ReadInto(NeighboursModel& sensor, const Source& source) {
  XmlAttributes& attributes = source.attributes;
  attributes.Require("range");
  if (auto v = attributes.Number("range", 1e-3, kMaxLength_m)) sensor.range_m = *v;
  sensor.message_range_m = attributes.Number("message_range", 0, kMaxLength_m).value_or(sensor.range_m);
  if (auto v = attributes.Number("loss", 0, 1)) sensor.loss = *v;
  if (auto v = attributes.Integer("delay_steps", 0, NeighboursModel::kMaxDelaySteps)) sensor.delay_steps = *v;
  ReadSightNoise(sensor, attributes);
}

void ReadInto(CompassModel& sensor, const Source& source) {
  if (auto v = source.attributes.Number("noise_stddev_deg", 0, 180)) sensor.noise_stddev_rad = *v * kDegree;
}

void ReadInto(SupportModel& sensor, const Source& source) {
  XmlAttributes& attributes = source.attributes;
  attributes.Require("link");
  attributes.Require("height");
  if (auto v = attributes.Text("link")) sensor.link = *v;
  if (auto v = attributes.Number("height", 0, kMaxLength_m)) sensor.height_m = *v;
  if (auto v = attributes.Number("noise_stddev", 0, kMaxLength_m)) sensor.noise_stddev_m = *v;
  if (auto v = attributes.Number("angle_noise_stddev_deg", 0, 180))
    sensor.angle_noise_stddev_rad = *v * kDegree;
  const auto is_it = [&sensor](const LinkModel& link) { return link.name == sensor.link; };
  if (!sensor.link.empty() && std::ranges::none_of(source.links, is_it)) {
    std::vector<std::string> names;
    for (const LinkModel& link : source.links) names.push_back(link.name);
    attributes.Error("there is no link '" + sensor.link + "'" + DidYouMean(sensor.link, names));
  }
}

template <typename Kind>
SensorKind ReadKind(const Source& source) {
  Kind sensor;
  ReadInto(sensor, source);
  return sensor;
}

/// How a kind of sensor is written.
struct Words {
  std::string_view type;     // of its module
  std::string_view element;  // that describes it; empty: there is nothing to say
  std::string_view needed;   // an element to write, if it is needed
  SensorKind (*read)(const Source& source);
  SensorKind usual;  // without an element
};

/// The table of the sensors: a new kind is one line here.
std::span<const Words> Table() {
  static const std::array kTable = {
      Words{DistanceModel::kType, "coopdyn:distance_sensors", "<coopdyn:distance_sensors>",
            ReadKind<DistanceModel>, DistanceModel()},
      Words{TargetModel::kType, "coopdyn:target_sensor", "", ReadKind<TargetModel>, TargetModel()},
      Words{PoseModel::kType, "", "", ReadKind<PoseModel>, PoseModel()},
      Words{NeighboursModel::kType, "coopdyn:neighbours", "<coopdyn:neighbours range=\"1\"/>",
            ReadKind<NeighboursModel>, NeighboursModel()},
      Words{CompassModel::kType, "coopdyn:compass", "", ReadKind<CompassModel>, CompassModel()},
      Words{SupportModel::kType, "coopdyn:support", "<coopdyn:support link=\"cradle\" height=\"0.3\"/>",
            ReadKind<SupportModel>, SupportModel()},
  };
  return kTable;
}

}  // namespace

std::vector<std::string> SensorReader::Elements() {
  std::vector<std::string> names;
  for (const Words& words : Table()) {
    if (!words.element.empty()) names.emplace_back(words.element);
  }
  return names;
}

bool SensorReader::Read(const XMLElement& element) {
  const auto words = std::find_if(Table().begin(), Table().end(),
                                  [&element](const Words& one) { return one.element == element.Name(); });
  if (words == Table().end()) return false;
  XmlAttributes attributes(element, file_, diagnostics_);
  const std::string name = attributes.Text("name").value_or("");
  SensorKind kind = words->read({element, attributes, file_, robot_.links, diagnostics_});
  attributes.Finish();
  for (const Described& other : described_) {
    if (other.kind.index() == kind.index() && other.name == name) {
      attributes.Error("stands here twice: keep one, or give each the name=\"…\" of its module");
    }
  }
  described_.push_back({name, std::move(kind), attributes.where()});
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
  if (found == nullptr && !words->needed.empty() && !diagnostics_.has_errors()) {
    attributes.Error("a module '" + type + "' needs " + std::string(words->needed) + ": write it above");
  }
  if (found != nullptr) found->used = true;
  robot_.AddSensor(name, found != nullptr ? found->kind : words->usual);
}

void SensorReader::Finish() {
  for (const Described& one : described_) {
    if (one.used) continue;
    const Words& words = Table()[one.kind.index()];
    const std::string name = one.name.empty() ? "" : " name=\"" + one.name + "\"";
    diagnostics_.Error(one.where, "<" + std::string(words.element) +
                                      "> needs its module: write <coopdyn:module type=\"" +
                                      std::string(words.type) + "\"" + name + "/>");
  }
}

}  // namespace coopdyn
