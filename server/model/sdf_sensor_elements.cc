// SPDX-License-Identifier: MIT
// Reads SDF's <sensor>s into the models of sensor_models.h. For their places see sdf_sensor_places.cc.
#include <tinyxml2.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

#include "server/base/portable_math.h"
#include "server/model/sdf_sensors.h"
#include "server/model/values.h"

namespace coopdyn {

namespace {

using tinyxml2::XMLElement;

/// Reads values of the elements in one `<sensor>`. Reports errors with their lines.
class ElementValues {
 public:
  ElementValues(const XMLElement& sensor, const std::string& file, Diagnostics& diagnostics)
      : sensor_(sensor), file_(file), diagnostics_(diagnostics) {}

  /// The descendant of `parent` at `path`, e.g. "scan/horizontal"; null if none.
  static const XMLElement* Find(const XMLElement* parent, std::string_view path) {
    while (parent != nullptr && !path.empty()) {
      const std::string name(path.substr(0, path.find('/')));
      path.remove_prefix(std::min(path.size(), name.size() + 1));
      parent = parent->FirstChildElement(name.c_str());
    }
    return parent;
  }

  static std::string TextOf(const XMLElement* parent, std::string_view path, std::string otherwise = {}) {
    const XMLElement* element = Find(parent, path);
    if (element == nullptr || element->GetText() == nullptr) return otherwise;
    return std::string(Trim(element->GetText()));
  }

  double Number(const XMLElement* parent, std::string_view path, double otherwise, double min, double max) {
    const XMLElement* element = Find(parent, path);
    if (element == nullptr) return otherwise;
    const std::string text = TextOf(parent, path);
    const std::optional<double> value = ParsePlain(text);
    if (!value || *value < min || *value > max) {
      Error(*element, std::string("<") + element->Name() + "> must be a number from " + FormatNumber(min) +
                          " to " + FormatNumber(max) + ", not '" + text + "'");
      return otherwise;
    }
    return *value;
  }
  int Integer(const XMLElement* parent, std::string_view path, int otherwise, int min, int max) {
    return static_cast<int>(std::round(Number(parent, path, otherwise, min, max)));
  }

  /// The `<noise>` in the element at `path`.
  ValueNoise Noise(const XMLElement* parent, std::string_view path) {
    ValueNoise out;
    const XMLElement* host = Find(parent, path);
    const XMLElement* noise = host == nullptr ? nullptr : host->FirstChildElement("noise");
    if (noise == nullptr) return out;
    // The type is an attribute in the noise of values, but an element in that of scans and images.
    const char* attribute = noise->Attribute("type");
    const std::string type = ToLower(attribute != nullptr ? attribute : TextOf(noise, "type", "gaussian"));
    constexpr double kMost = 1e9;
    if (type == "none") return out;
    if (type != "gaussian" && type != "gaussian_quantized") {
      Error(*noise, "the type of <noise> is none, gaussian or gaussian_quantized, not '" + type + "'");
      return out;
    }
    out.stddev = Number(noise, "stddev", 0, 0, kMost);
    out.bias_mean = Number(noise, "mean", 0, -kMost, kMost) + Number(noise, "bias_mean", 0, -kMost, kMost);
    out.bias_stddev = Number(noise, "bias_stddev", 0, 0, kMost);
    if (type == "gaussian_quantized") out.resolution = Number(noise, "precision", 0, 0, kMost);
    return out;
  }
  /// The noises of x, y and z.
  std::array<ValueNoise, 3> Noises(const XMLElement* parent, const std::string& path) {
    return {Noise(parent, path + "/x"), Noise(parent, path + "/y"), Noise(parent, path + "/z")};
  }

  std::optional<Pose> PoseIn(const XMLElement* parent) {
    const XMLElement* element = Find(parent, "pose");
    if (element == nullptr) return Pose{};
    std::vector<double> v;
    for (const std::string& word : SplitWords(TextOf(parent, "pose")))
      v.push_back(ParsePlain(word).value_or(NAN));
    if (v.size() != 6 ||
        std::ranges::any_of(v, [](double x) { return !(std::abs(x) <= kMaxSensorLength_m); })) {
      Error(*element, "<pose> of a camera is x y z roll pitch yaw in its sensor");
      return std::nullopt;
    }
    return Pose{Vector3(v[0], v[1], v[2]), FromRollPitchYaw(v[3], v[4], v[5])};
  }

  void Error(const XMLElement& at, const std::string& text) {
    diagnostics_.Error({file_, at.GetLineNum()}, "sensor '" + name() + "': " + text);
  }
  void Mended(const XMLElement& at, const std::string& text) {
    diagnostics_.Mended({file_, at.GetLineNum()}, "sensor '" + name() + "': " + text);
  }
  std::string name() const {
    const char* name = sensor_.Attribute("name");
    return name == nullptr ? "" : name;
  }
  const XMLElement& sensor() const { return sensor_; }

 private:
  const XMLElement& sensor_;
  const std::string& file_;
  Diagnostics& diagnostics_;
};

ImuModel ToImu(ElementValues& values) {
  ImuModel imu;
  imu.turn_noise = values.Noises(&values.sensor(), "imu/angular_velocity");
  imu.acceleration_noise = values.Noises(&values.sensor(), "imu/linear_acceleration");
  return imu;
}

WrenchModel ToWrench(ElementValues& values, std::string& frame) {
  WrenchModel wrench;
  const XMLElement* element = values.sensor().FirstChildElement("force_torque");
  frame = ElementValues::TextOf(element, "frame", "child");
  const std::string direction = ElementValues::TextOf(element, "measure_direction", "child_to_parent");
  if (!ParseWrenchFrame(frame))
    values.Error(*ElementValues::Find(element, "frame"),
                 "<frame> is child, parent or sensor, not '" + frame + "'");
  if (direction != "child_to_parent" && direction != "parent_to_child") {
    values.Error(*ElementValues::Find(element, "measure_direction"),
                 "<measure_direction> is child_to_parent or parent_to_child, not '" + direction + "'");
  }
  wrench.on_parent = direction != "parent_to_child";
  wrench.force_noise = values.Noises(element, "force");
  wrench.torque_noise = values.Noises(element, "torque");
  return wrench;
}

LidarModel ToLidar(ElementValues& values) {
  LidarModel lidar;
  const XMLElement* element = values.sensor().FirstChildElement("lidar");
  if (element == nullptr) element = values.sensor().FirstChildElement("ray");
  constexpr double kMostAngle = 7;
  const auto count = [&](const std::string& path, int otherwise) {
    const int samples = values.Integer(element, path + "/samples", otherwise, 1, kMaxLidarRays);
    const double factor = values.Number(element, path + "/resolution", 1, 1e-3, 1e3);
    return std::max(1, static_cast<int>(std::round(std::min(samples * factor, 1e9))));
  };
  constexpr int kUsualColumns = 640;  // SDF's default
  lidar.columns = count("scan/horizontal", kUsualColumns);
  lidar.rows = count("scan/vertical", 1);
  const auto angle = [&](const char* path) {
    return values.Number(element, path, 0, -kMostAngle, kMostAngle);
  };
  lidar.first_azimuth_rad = angle("scan/horizontal/min_angle");
  lidar.last_azimuth_rad = angle("scan/horizontal/max_angle");
  lidar.first_elevation_rad = angle("scan/vertical/min_angle");
  lidar.last_elevation_rad = angle("scan/vertical/max_angle");
  const auto sort = [&](const char* path, double& first_rad, double& last_rad) {
    if (first_rad <= last_rad) return;
    values.Mended(*ElementValues::Find(element, path),
                  "<min_angle> lies above <max_angle>: they are taken the other way round");
    std::swap(first_rad, last_rad);
  };
  sort("scan/horizontal", lidar.first_azimuth_rad, lidar.last_azimuth_rad);
  sort("scan/vertical", lidar.first_elevation_rad, lidar.last_elevation_rad);
  // One ray looks along the first angle, as in Gazebo.
  if (lidar.columns == 1) lidar.last_azimuth_rad = lidar.first_azimuth_rad;
  if (lidar.rows == 1) lidar.last_elevation_rad = lidar.first_elevation_rad;
  lidar.min_range_m = values.Number(element, "range/min", 0, 0, kMaxSensorLength_m);
  if (ElementValues::Find(element, "range/max") == nullptr) {
    values.Error(values.sensor(), "needs <range><max>, in m");
    return lidar;
  }
  // Some models have a huge number for unlimited.
  lidar.max_range_m = values.Number(element, "range/max", 1, 0, 1e12);
  lidar.max_range_m = std::min(lidar.max_range_m, kMaxSensorLength_m);
  lidar.noise = values.Noise(element, "");
  lidar.noise.resolution =
      std::max(lidar.noise.resolution, values.Number(element, "range/resolution", 0, 0, kMaxSensorLength_m));
  if (const std::string wrong = lidar.Wrong(); !wrong.empty()) values.Error(values.sensor(), wrong);
  return lidar;
}

SonarModel ToSonar(ElementValues& values) {
  SonarModel sonar;
  const XMLElement* element = values.sensor().FirstChildElement("sonar");
  SonarModel::Beam beam;
  beam.min_range_m = values.Number(element, "min", 0, 0, kMaxSensorLength_m);
  beam.max_range_m = values.Number(element, "max", 1, 1e-3, kMaxSensorLength_m);
  const double radius_m = values.Number(element, "radius", 0.5, 0, kMaxSensorLength_m);
  beam.opening_rad = 2 * portable::Atan(radius_m / beam.max_range_m);
  if (beam.min_range_m >= beam.max_range_m)
    values.Error(values.sensor(), "<min> of <sonar> must lie below <max>");
  if (const std::string shape = ElementValues::TextOf(element, "geometry", "cone"); shape != "cone")
    values.Error(*ElementValues::Find(element, "geometry"),
                 "<geometry> of <sonar> is cone, not '" + shape + "'");
  sonar.beams.push_back(beam);
  return sonar;
}

CameraModel ToCamera(ElementValues& values, const XMLElement* element, bool is_depth) {
  CameraModel camera;
  const XMLElement& at = element == nullptr ? values.sensor() : *element;
  camera.horizontal_fov_rad = values.Number(element, "horizontal_fov", camera.horizontal_fov_rad, 0, 7);
  camera.width = values.Integer(element, "image/width", camera.width, 1, 1'000'000);
  camera.height = values.Integer(element, "image/height", camera.height, 1, 1'000'000);
  const XMLElement* clip = ElementValues::Find(element, "depth_camera/clip");
  if (clip == nullptr || !is_depth) clip = ElementValues::Find(element, "clip");
  constexpr double kUsualNear_m = 0.1, kUsualFar_m = 100, kDepthFar_m = 10;  // SDF's defaults
  const bool own = clip != nullptr && clip != ElementValues::Find(element, "clip");
  camera.near_m = values.Number(clip, "near", kUsualNear_m, 0, kMaxSensorLength_m);
  camera.far_m = values.Number(clip, "far", own ? kDepthFar_m : kUsualFar_m, 0, 1e12);
  camera.far_m = std::min(camera.far_m, kMaxSensorLength_m);
  (is_depth ? camera.depth_noise : camera.noise) = values.Noise(element, "");
  if (const std::string wrong = camera.Wrong(); !wrong.empty()) values.Error(at, wrong);
  return camera;
}

constexpr std::string_view kCameras[] = {"camera", "depth_camera", "depth",        "rgbd_camera",
                                         "rgbd",   "multicamera",  "segmentation", "segmentation_camera"};
constexpr std::string_view kLidars[] = {"ray", "gpu_ray", "lidar", "gpu_lidar"};

bool IsOneOf(std::string_view word, const auto& words) {
  return std::ranges::find(words, word) != std::end(words);
}

class ElementReader {
 public:
  ElementReader(const std::string& file, Diagnostics& diagnostics) : file_(file), diagnostics_(diagnostics) {}

  void Read(const XMLElement& model, const std::string& prefix, int depth) {
    constexpr int kMaxDepth = 40;
    if (depth > kMaxDepth) return;
    for (const XMLElement* child = model.FirstChildElement(); child != nullptr;
         child = child->NextSiblingElement()) {
      const std::string_view kind = child->Name();
      const char* name = child->Attribute("name");
      if (kind == "model") Read(*child, prefix + (name == nullptr ? "" : name) + "::", depth + 1);
      if ((kind != "link" && kind != "joint") || name == nullptr) continue;
      for (const XMLElement* sensor = child->FirstChildElement("sensor"); sensor != nullptr;
           sensor = sensor->NextSiblingElement("sensor")) {
        ReadSensor(*sensor, prefix, *child);
      }
    }
  }
  std::vector<SdfSensor> Take() { return std::move(sensors_); }

 private:
  void ReadSensor(const XMLElement& element, const std::string& prefix, const XMLElement& host) {
    const bool on_joint = std::string_view(host.Name()) == "joint";
    const char* type_text = element.Attribute("type");
    const std::string type = type_text == nullptr ? "" : type_text;
    if (!IsUsedSensor(type)) return;  // reported before
    ElementValues values(element, file_, diagnostics_);
    SdfSensor out;
    out.name = values.name();
    out.scope = prefix;
    out.host = host.Attribute("name");
    const char* given = host.Attribute("coopdyn:name");
    out.joint = prefix + (given == nullptr ? out.host : given);
    out.on_joint = on_joint;
    out.module = ModuleName(out.name);
    out.where = {file_, element.GetLineNum()};
    out.timing.rate_hz = values.Number(&element, "update_rate", 0, 0, kMaxSensorRate_hz);
    if (on_joint != (type == "force_torque")) {
      values.Error(element, on_joint
                                ? "a sensor of type " + type + " belongs into a <link>, not into a <joint>"
                                : "a force_torque sensor belongs into a <joint>, not into a <link>");
      return;
    }
    if (type == "imu") {
      out.kind = ToImu(values);
    } else if (type == "force_torque") {
      out.kind = ToWrench(values, out.wrench_frame);
    } else if (IsOneOf(type, kLidars)) {
      out.kind = ToLidar(values);
    } else if (type == "sonar") {
      out.kind = ToSonar(values);
    } else if (type == "contact") {
      out.kind = ContactModel();
      const XMLElement* contact = element.FirstChildElement("contact");
      const XMLElement* one = contact == nullptr ? nullptr : contact->FirstChildElement("collision");
      for (; one != nullptr; one = one->NextSiblingElement("collision")) {
        if (one->GetText() != nullptr) out.collisions.emplace_back(Trim(one->GetText()));
      }
    } else {
      return ReadCameras(element, type, values, out);
    }
    sensors_.push_back(std::move(out));
  }

  void ReadCameras(const XMLElement& element, const std::string& type, ElementValues& values,
                   const SdfSensor& of) {
    const bool is_depth = type.starts_with("depth");
    const XMLElement* camera = element.FirstChildElement("camera");
    const bool many = camera != nullptr && camera->NextSiblingElement("camera") != nullptr;
    do {
      SdfSensor out = of;
      out.kind = ToCamera(values, camera, is_depth);
      if (camera != nullptr) out.X_SC = values.PoseIn(camera).value_or(Pose{});
      const char* name = camera == nullptr ? nullptr : camera->Attribute("name");
      if (many) out.module = ModuleName(out.name + "_" + (name == nullptr ? "" : name));
      sensors_.push_back(std::move(out));
      camera = camera == nullptr ? nullptr : camera->NextSiblingElement("camera");
    } while (camera != nullptr);
  }

  const std::string& file_;
  Diagnostics& diagnostics_;
  std::vector<SdfSensor> sensors_;
};

}  // namespace

bool IsUsedSensor(std::string_view type) {
  return type == "imu" || type == "force_torque" || type == "sonar" || type == "contact" ||
         IsOneOf(type, kLidars) || IsOneOf(type, kCameras);
}

std::string ModuleName(std::string_view name) {
  constexpr std::size_t kMaxSize = 32;
  std::string out;
  for (const char c : ToLower(name)) {
    const bool good = (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9');
    if (good || (!out.empty() && out.back() != '_')) out += good ? c : '_';
  }
  while (out.ends_with('_')) out.pop_back();
  if (out.empty() || out.front() < 'a') out = "s" + (out.empty() ? "ensor" : "_" + out);
  out.resize(std::min(out.size(), kMaxSize));
  return out;
}

std::vector<SdfSensor> ReadSensorElements(const XMLElement& model, const std::string& file,
                                          Diagnostics& diagnostics) {
  ElementReader reader(file, diagnostics);
  reader.Read(model, "", 0);
  return reader.Take();
}

}  // namespace coopdyn
