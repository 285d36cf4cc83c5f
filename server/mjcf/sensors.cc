// SPDX-License-Identifier: MIT
// Writes sensors on sites, cameras, and actuators on sites as thrusters.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <set>
#include <string_view>

#include "server/base/portable_math.h"
#include "server/mjcf/parts.h"
#include "server/mjcf/sdf_text.h"

namespace coopdyn::mjcf {

namespace {

using tinyxml2::XMLElement;

XMLElement* NamedChild(XMLElement& parent, const char* element, const std::string& name) {
  for (XMLElement* one = parent.FirstChildElement(element); one != nullptr;
       one = one->NextSiblingElement(element)) {
    if (one->Attribute("name") == name) return one;
  }
  return nullptr;
}

XMLElement& AddSensor(XMLElement& host, const std::string& name, const char* type, const Pose& X_HS) {
  XMLElement& sensor = AddNamed(host, "sensor", name);
  sensor.SetAttribute("type", type);
  AddPose(sensor, X_HS);
  return sensor;
}

Pose SitePose(const mjModel& m, int site) {
  return ToPose(m.site_pos + 3 * site, m.site_quat + 4 * site);
}

/// MuJoCo's rangefinders point along z, coopdyn's along x.
void AddRangefinder(const std::string& name, double cutoff_m, const Pose& X_BS, XMLElement& link) {
  constexpr double kFar_m = 100;
  const Pose X_SR{Vector3::Zero(), portable::AngleAxis(-std::numbers::pi / 2, Vector3::UnitY())};
  XMLElement& ray = Add(AddSensor(link, name, "ray", X_BS * X_SR), "ray");
  XMLElement& horizontal = Add(Add(ray, "scan"), "horizontal");
  for (const auto& [key, value] :
       {std::pair("samples", "1"), {"resolution", "1"}, {"min_angle", "0"}, {"max_angle", "0"}})
    Add(horizontal, key, value);
  XMLElement& range = Add(ray, "range");
  Add(range, "min", "0");
  Add(range, "max", Number(cutoff_m > 0 ? cutoff_m : kFar_m));
}

void AddTouch(const std::string& name, XMLElement& link) {
  XMLElement* const collision = link.FirstChildElement("collision");
  if (collision == nullptr) return;
  XMLElement& contact = Add(AddSensor(link, name, "contact", Pose()), "contact");
  for (const XMLElement* one = collision; one != nullptr; one = one->NextSiblingElement("collision"))
    Add(contact, "collision", one->Attribute("name"));
}

void AddWrench(const std::string& name, const Pose& X_BS, XMLElement& joint) {
  XMLElement& element = Add(AddSensor(joint, name, "force_torque", X_BS), "force_torque");
  Add(element, "frame", "sensor");
  Add(element, "measure_direction", "child_to_parent");
}

/// MuJoCo's cameras look along −z with y up, coopdyn's along x with z up.
void AddCamera(int camera, const Source& source, XMLElement& link) {
  const mjModel& m = source.model();
  constexpr int kWidth = 320, kHeight = 240;
  Matrix3 R_CS;
  R_CS << 0, -1, 0, 0, 0, 1, -1, 0, 0;
  const Pose X_BC = ToPose(m.cam_pos + 3 * camera, m.cam_quat + 4 * camera);
  const double up_rad = m.cam_fovy[camera] * std::numbers::pi / 180;
  const double tangent = portable::Sin(up_rad / 2) / portable::Cos(up_rad / 2) * kWidth / kHeight;
  XMLElement& element = Add(AddSensor(link, source.NameOf(mjOBJ_CAMERA, camera, "camera"), "camera",
                                      X_BC * Pose{Vector3::Zero(), Quaternion(R_CS)}),
                            "camera");
  constexpr double kWidest_rad = 3.05;  // 175 degrees
  Add(element, "horizontal_fov", Number(std::min(kWidest_rad, 2 * portable::Atan2(tangent, 1))));
  XMLElement& image = Add(element, "image");
  Add(image, "width", std::to_string(kWidth));
  Add(image, "height", std::to_string(kHeight));
  XMLElement& clip = Add(element, "clip");
  Add(clip, "near", "0.01");
  Add(clip, "far", "100");
}

bool Has(const std::vector<int>& bodies, int body) {
  return std::ranges::find(bodies, body) != bodies.end();
}

/// The coopdyn sensor that replaces a MuJoCo sensor. kQuiet: another module reports the value.
enum class Kind { kNone, kQuiet, kImu, kWrench, kRange, kTouch };
Kind KindOf(int type) {
  switch (type) {
    case mjSENS_ACCELEROMETER:
    case mjSENS_GYRO:
      return Kind::kImu;
    case mjSENS_FORCE:
    case mjSENS_TORQUE:
      return Kind::kWrench;
    case mjSENS_RANGEFINDER:
      return Kind::kRange;
    case mjSENS_TOUCH:
      return Kind::kTouch;
    // The joints and pose modules report these.
    case mjSENS_JOINTPOS:
    case mjSENS_JOINTVEL:
    case mjSENS_ACTUATORPOS:
    case mjSENS_ACTUATORVEL:
    case mjSENS_ACTUATORFRC:
    case mjSENS_CLOCK:
      return Kind::kQuiet;
    default:
      return Kind::kNone;
  }
}

constexpr std::array<std::string_view, mjSENS_USER + 1> kWords = {
    "touch",         "accelerometer", "velocimeter",    "gyro",           "force",          "torque",
    "magnetometer",  "rangefinder",   "jointpos",       "jointvel",       "tendonpos",      "tendonvel",
    "actuatorpos",   "actuatorvel",   "actuatorfrc",    "ballquat",       "ballangvel",     "jointlimitpos",
    "jointlimitvel", "jointlimitfrc", "tendonlimitpos", "tendonlimitvel", "tendonlimitfrc", "framepos",
    "framequat",     "framexaxis",    "frameyaxis",     "framezaxis",     "framelinvel",    "frameangvel",
    "framelinacc",   "frameangacc",   "subtreecom",     "subtreelinvel",  "subtreeangmom",  "clock",
    "user"};

}  // namespace

void SaySensors(const Source& source) {
  const mjModel& m = source.model();
  std::set<std::string> words;
  for (int i = 0; i < m.nsensor; ++i) {
    if (KindOf(m.sensor_type[i]) == Kind::kNone)
      words.insert(std::string(kWords[static_cast<std::size_t>(m.sensor_type[i])]));
  }
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  if (!text.empty()) source.words().Say("sensors that have no equal here are left out: " + text, false);
}

void AddSensors(const std::vector<int>& bodies, const Source& source, XMLElement& model) {
  const mjModel& m = source.model();
  std::set<std::pair<Kind, int>> done;  // at most one IMU and one wrench sensor per site
  for (int i = 0; i < m.nsensor; ++i) {
    const Kind kind = KindOf(m.sensor_type[i]);
    const int site = m.sensor_objid[i];
    if (kind == Kind::kNone || kind == Kind::kQuiet || m.sensor_objtype[i] != mjOBJ_SITE ||
        !Has(bodies, m.site_bodyid[site]))
      continue;
    const bool is_shared = kind == Kind::kImu || kind == Kind::kWrench;
    if (is_shared && !done.emplace(kind, site).second) continue;
    const int body = m.site_bodyid[site];
    const std::string name =
        is_shared ? source.NameOf(mjOBJ_SITE, site, "site") : source.NameOf(mjOBJ_SENSOR, i, "sensor");
    XMLElement* const link = NamedChild(model, "link", source.BodyName(body));
    if (link == nullptr) continue;
    const Pose X_BS = SitePose(m, site);
    if (kind == Kind::kImu) AddSensor(*link, name, "imu", X_BS);
    if (kind == Kind::kRange) AddRangefinder(name, m.sensor_cutoff[i], X_BS, *link);
    if (kind == Kind::kTouch) AddTouch(name, *link);
    XMLElement* const joint = NamedChild(model, "joint", FirstJointName(body, source));
    if (kind == Kind::kWrench && joint != nullptr) AddWrench(name, X_BS, *joint);
  }
  for (int i = 0; i < m.ncam; ++i) {
    if (!Has(bodies, m.cam_bodyid[i])) continue;
    XMLElement* const link = NamedChild(model, "link", source.BodyName(m.cam_bodyid[i]));
    if (m.cam_mode[i] == mjCAMLIGHT_FIXED && link != nullptr)
      AddCamera(i, source, *link);
    else
      source.words().Say("a camera that follows something is left out");
  }
}

void AddThrusters(const std::vector<int>& bodies, const Source& source, XMLElement& model) {
  const mjModel& m = source.model();
  for (int i = 0; i < m.nu; ++i) {
    const int site = m.actuator_trnid[2 * i];
    if (m.actuator_trntype[i] != mjTRN_SITE || !Has(bodies, m.site_bodyid[site])) continue;
    const Pose X_BS = SitePose(m, site);
    const Vector3 force = ToVector(m.actuator_gear + 6 * i), torque = ToVector(m.actuator_gear + 6 * i + 3);
    const double limit = ForceLimit(m, i);
    if (limit == 0 || m.actuator_trnid[2 * i + 1] >= 0) {
      source.words().Say(
          "an actuator on a site without forcerange and ctrlrange, or with a refsite, is left out");
      continue;
    }
    const std::string name = source.NameOf(mjOBJ_ACTUATOR, i, "thruster");
    const auto add = [&](const std::string& called, const Vector3& gear, const char* most) {
      XMLElement& thruster = AddNamed(model, "coopdyn:thruster", called);
      thruster.SetAttribute("link", source.BodyName(m.site_bodyid[site]).c_str());
      thruster.SetAttribute("direction", Numbers(X_BS.q * gear.normalized()).c_str());
      thruster.SetAttribute(most, Number(limit * gear.norm()).c_str());
      return &thruster;
    };
    if (force.norm() > 0) add(name, force, "max_force_n")->SetAttribute("point", Numbers(X_BS.p).c_str());
    if (torque.norm() > 0) add(force.norm() > 0 ? name + "_torque" : name, torque, "max_torque_nm");
  }
}

}  // namespace coopdyn::mjcf
