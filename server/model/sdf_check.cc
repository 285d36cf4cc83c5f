// SPDX-License-Identifier: MIT
// Checks that libsdformat omits: unknown and unused elements, words in place of numbers.
#include <tinyxml2.h>

#include <algorithm>
#include <functional>
#include <map>
#include <optional>
#include <sdf/Param.hh>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "server/model/sdf_parts.h"
#include "server/model/values.h"

namespace coopdyn {

namespace {

using tinyxml2::XMLAttribute;
using tinyxml2::XMLElement;

/// Elements that the reader uses, by parent element.
constexpr std::pair<std::string_view, std::string_view> kUsed[] = {
    {"sdf", "model"},
    {"model", "link joint frame model"},
    {"frame", "pose"},
    {"link", "pose inertial collision visual sensor"},
    {"inertial", "pose mass inertia"},
    {"inertia", "ixx iyy izz ixy ixz iyz"},
    {"collision", "pose geometry surface"},
    {"visual", "pose geometry material"},
    {"geometry", "box cylinder sphere capsule plane mesh heightmap ellipsoid cone"},
    {"ellipsoid", "radii"},
    {"cone", "radius length"},
    {"heightmap", "uri size pos sampling"},
    {"capsule", "radius length"},
    {"plane", "normal size"},
    {"mesh", "uri scale submesh convex_decomposition"},
    {"convex_decomposition", "max_convex_hulls voxel_resolution"},
    {"submesh", "name center"},
    {"box", "size"},
    {"cylinder", "radius length"},
    {"sphere", "radius"},
    {"surface", "friction bounce contact"},
    {"bounce", "restitution_coefficient"},
    {"friction", "ode torsional bullet"},
    {"ode", "mu mu2 fdir1 kp kd"},
    {"torsional", "coefficient use_patch_radius patch_radius"},
    {"bullet", "rolling_friction"},
    {"material", "diffuse ambient specular pbr"},
    {"pbr", "metal specular"},
    {"metal", "albedo_map"},
    {"specular", "albedo_map"},
    {"joint", "pose parent child axis axis2 gearbox_ratio gearbox_reference_body thread_pitch sensor"},
    {"axis", "xyz limit dynamics"},
    {"axis2", "xyz limit dynamics"},
    {"dynamics", "damping friction spring_reference spring_stiffness"},
    {"limit", "lower upper effort velocity"},
    // For sensors, also elements that are meaningless without topics.
    {"sensor",
     "pose update_rate always_on visualize topic enable_metrics imu ray lidar force_torque contact sonar "
     "camera"},
    {"imu", "angular_velocity linear_acceleration"},
    {"angular_velocity", "x y z"},
    {"linear_acceleration", "x y z"},
    {"force", "x y z"},
    {"torque", "x y z"},
    {"x", "noise"},
    {"y", "noise"},
    {"z", "noise"},
    {"noise", "type mean stddev bias_mean bias_stddev precision"},
    {"ray", "scan range noise"},
    {"lidar", "scan range noise"},
    {"scan", "horizontal vertical"},
    {"horizontal", "samples resolution min_angle max_angle"},
    {"vertical", "samples resolution min_angle max_angle"},
    {"range", "min max resolution"},
    {"force_torque", "frame measure_direction force torque"},
    {"contact", "collision topic ode"},
    {"sonar", "min max radius geometry"},
    {"camera", "pose horizontal_fov image clip depth_camera noise"},
    {"image", "width height format"},
    {"clip", "near far"},
    {"depth_camera", "clip output"},
};

bool IsForeign(std::string_view name) {
  return name.find(':') != std::string_view::npos;
}

}  // namespace

bool IsUsedElement(std::string_view parent, const std::string& name) {
  return std::ranges::any_of(kUsed, [&](const auto& used) {
    return used.first == parent && std::ranges::count(SplitWords(used.second), name) > 0;
  });
}

namespace {

class Checker {
 public:
  Checker(const std::string& file, bool lenient, Diagnostics& diagnostics)
      : file_(file), lenient_(lenient), diagnostics_(diagnostics) {}

  void Check(const XMLElement& element, const sdf::ElementPtr& description, int depth) {
    constexpr int kMaxDepth = 40;
    if (depth > kMaxDepth) {
      diagnostics_.Error({file_, element.GetLineNum()}, "elements are nested too deeply");
      return;
    }
    CheckAttributes(element, description);
    CheckValue(element, description);
    for (const XMLElement* child = element.FirstChildElement(); child != nullptr;
         child = child->NextSiblingElement()) {
      if (diagnostics_.StopAt({file_, child->GetLineNum()})) return;
      if (!IsForeign(child->Name())) CheckChild(element, description, *child, depth);
    }
  }

 private:
  void CheckChild(const XMLElement& parent, const sdf::ElementPtr& description, const XMLElement& child,
                  int depth) {
    const std::string name = child.Name();
    const SourceLine where{file_, child.GetLineNum()};
    if (!description->HasElementDescription(name)) {
      std::vector<std::string> known;
      for (std::size_t i = 0; i < description->GetElementDescriptionCount(); ++i) {
        known.push_back(description->GetElementDescription(static_cast<unsigned>(i))->GetName());
      }
      diagnostics_.Error(
          where, "unknown element <" + name + "> in <" + parent.Name() + ">" + DidYouMean(name, known));
      return;
    }
    const std::string path = std::string(parent.Name()) + "/" + name;
    const bool nested_pose = path == "model/pose" && depth > 1;
    if (name == "sensor" && !IsKnownType(child)) return;
    if (name == "sensor") CheckSensorName(child, where);
    if (nested_pose || IsUsedElement(parent.Name(), name)) {
      // SDF's schema describes a nested model by the outer one.
      Check(child, path == "model/model" ? description : description->GetElementDescription(name), depth + 1);
    } else if (std::string_view(parent.Name()) == "geometry") {
      diagnostics_.Error(where, "the shape <" + name +
                                    "> is not supported: use <box>, <cylinder>, <sphere>, <capsule>, "
                                    "<ellipsoid>, <cone>, <plane>, <mesh> or <heightmap>");
    } else if (path == "model/static" || path == "sdf/world") {
      diagnostics_.Error(where, "<" + name + "> does not belong in a robot: remove it");
    } else {
      diagnostics_.LeftOut(where, "<" + name + "> in <" + parent.Name() + ">");
    }
  }

  /// Reports duplicate names of sensors: libsdformat's message has no line.
  void CheckSensorName(const XMLElement& sensor, const SourceLine& where) {
    const char* name = sensor.Attribute("name");
    for (const XMLElement* other = sensor.PreviousSiblingElement("sensor");
         name != nullptr && other != nullptr; other = other->PreviousSiblingElement("sensor")) {
      if (!other->Attribute("name", name)) continue;
      diagnostics_.Error(
          where, std::string("another <sensor> here is called '") + name + "': give each a name of its own");
      return;
    }
  }

  /// True if coopdyn simulates this type of sensor. Reports other types.
  bool IsKnownType(const XMLElement& sensor) {
    const char* text = sensor.Attribute("type");
    const std::string type = text == nullptr ? "" : text;
    if (IsUsedSensor(type)) return true;
    const SourceLine where{file_, sensor.GetLineNum()};
    static const std::vector<std::string> kOthers = {"air_pressure",
                                                     "altimeter",
                                                     "boundingbox_camera",
                                                     "boundingbox",
                                                     "custom",
                                                     "gps",
                                                     "logical_camera",
                                                     "magnetometer",
                                                     "navsat",
                                                     "rfid",
                                                     "rfidtag",
                                                     "thermal_camera",
                                                     "thermal",
                                                     "wideanglecamera",
                                                     "wide_angle_camera",
                                                     "air_speed",
                                                     "wireless_receiver",
                                                     "wireless_transmitter"};
    if (std::ranges::find(kOthers, type) != kOthers.end()) {
      diagnostics_.LeftOut(
          where, "<sensor type=\"" + type + "\"> in <" + sensor.Parent()->ToElement()->Name() + ">");
    } else {
      static const std::vector<std::string> kOwn = {"imu",   "force_torque", "lidar",       "contact",
                                                    "sonar", "camera",       "depth_camera"};
      diagnostics_.Error(where, type.empty()
                                    ? "<sensor> needs a type, for example type=\"imu\""
                                    : "unknown type '" + type + "' of <sensor>" + DidYouMean(type, kOwn));
    }
    return false;
  }

  void CheckAttributes(const XMLElement& element, const sdf::ElementPtr& description) {
    if (diagnostics_.StopAt({file_, element.GetLineNum()})) return;
    for (const XMLAttribute* attribute = element.FirstAttribute(); attribute != nullptr;
         attribute = attribute->Next()) {
      const std::string name = attribute->Name();
      const SourceLine where{file_, attribute->GetLineNum()};
      if (IsForeign(name) || name == "xmlns") continue;
      if (!description->HasAttribute(name)) {
        std::vector<std::string> known;
        for (std::size_t i = 0; i < description->GetAttributeCount(); ++i) {
          known.push_back(description->GetAttribute(static_cast<unsigned>(i))->GetKey());
        }
        const std::string text =
            "unknown attribute '" + name + "' of <" + element.Name() + ">" + DidYouMean(name, known);
        lenient_ ? diagnostics_.Note(where, text) : diagnostics_.Error(where, text);
      } else if (!description->GetAttribute(name)->Clone()->SetFromString(attribute->Value())) {
        diagnostics_.Error(where, "attribute '" + name + "' of <" + element.Name() + "> cannot be '" +
                                      attribute->Value() + "'");
      }
    }
    for (std::size_t i = 0; i < description->GetAttributeCount(); ++i) {
      const sdf::ParamPtr attribute = description->GetAttribute(static_cast<unsigned>(i));
      if (attribute->GetRequired() && element.Attribute(attribute->GetKey().c_str()) == nullptr) {
        diagnostics_.Error(
            {file_, element.GetLineNum()},
            std::string("<") + element.Name() + "> needs the attribute '" + attribute->GetKey() + "'");
      }
    }
  }

  void CheckValue(const XMLElement& element, const sdf::ElementPtr& description) {
    const sdf::ParamPtr value = description->GetValue();
    if (value == nullptr) return;
    const std::string text = element.GetText() == nullptr ? "" : element.GetText();
    const std::string shown = "'" + text + "'";
    const SourceLine where{file_, element.GetLineNum()};
    const std::string type = value->GetTypeName();
    const bool number = type == "double" || type == "float" || type == "int" || type == "unsigned int" ||
                        type.find("Vector") != std::string::npos ||
                        type.find("vector") != std::string::npos || type.find("Pose") != std::string::npos ||
                        type.find("pose") != std::string::npos || type.find("olor") != std::string::npos;
    if (number) {
      std::string spaced = text;
      std::replace_if(
          spaced.begin(), spaced.end(), [](char c) { return c == '\n' || c == '\r'; }, ' ');
      const std::vector<std::string> words = SplitWords(spaced);
      for (const std::string& word : words) {
        if (!ParsePlain(word)) {
          diagnostics_.Error(where,
                             std::string("<") + element.Name() + "> needs finite numbers, not " + shown);
          return;
        }
      }
      const bool is_pose = std::string_view(element.Name()) == "pose";  // an empty <pose> is the identity
      if (words.empty() && !is_pose) {
        diagnostics_.Error(where, std::string("<") + element.Name() + "> is empty: write its numbers");
        return;
      }
    }
    // A pose's attributes determine the form of its text.
    const sdf::ElementPtr read = element.FirstAttribute() == nullptr ? description : description->Clone();
    for (const XMLAttribute* each = element.FirstAttribute(); each != nullptr; each = each->Next()) {
      if (read->HasAttribute(each->Name())) read->GetAttribute(each->Name())->SetFromString(each->Value());
    }
    if (!text.empty() && !read->GetValue()->Clone()->SetFromString(text)) {
      diagnostics_.Error(where,
                         std::string("<") + element.Name() + "> cannot be " + shown + AdviceOn(*value));
    }
  }

  /// What to write instead of a text that `value` does not take, after a colon; empty if it has many forms.
  static std::string AdviceOn(const sdf::Param& value) {
    const std::string& type = value.GetTypeName();
    if (type == "bool") return ": write true or false";
    if (type.find("ector3") != std::string::npos) return ": write three numbers";
    const auto least = value.GetMinValueAsString(), most = value.GetMaxValueAsString();
    if (least && most) return ": write a number from " + *least + " to " + *most;
    if (least) return ": write a number from " + *least + " on";
    return most ? ": write a number up to " + *most : "";
  }

  const std::string& file_;
  const bool lenient_;  // the model was made for other programs
  Diagnostics& diagnostics_;
};

std::string TooMany(int most, const std::string& what) {
  return "a robot's model has at most " + std::to_string(most) + " " + what + ": make it simpler";
}

/// The line of the first element with more than kMaxElementAttributes. Call it before parsing, because
/// tinyxml2 compares each attribute with all previous ones.
std::optional<int> LineOfTooManyAttributes(std::string_view text) {
  int line = 1, values = 0;
  bool in_tag = false;
  const auto skip = [&](std::size_t count) {
    const std::string_view taken = text.substr(0, count);
    line += static_cast<int>(std::ranges::count(taken, '\n'));
    text.remove_prefix(taken.size());
  };
  const auto skip_past = [&](std::string_view end) {
    const std::size_t at = text.find(end);
    skip(at == std::string_view::npos ? text.size() : at + end.size());
  };
  while (!text.empty()) {
    const char c = text.front();
    if (!in_tag && text.starts_with("<!--")) {
      skip_past("-->");
    } else if (!in_tag && text.starts_with("<![CDATA[")) {
      skip_past("]]>");
    } else if (in_tag && (c == '"' || c == '\'')) {
      if (++values > kMaxElementAttributes) return line;
      skip(1);
      skip_past(std::string_view(&c, 1));
    } else {
      if (c == '<' && !in_tag) values = 0;
      in_tag = c == '<' || (in_tag && c != '>');
      skip(1);
    }
  }
  return {};
}

}  // namespace

bool IsModelSize(std::string_view text, const std::string& file, Diagnostics& diagnostics) {
  if (text.size() > kMaxModelBytes) {
    diagnostics.Error({file, 0}, "a robot's model has at most " + std::to_string(kMaxModelBytes >> 20) +
                                     " MiB: make it simpler");
    return false;
  }
  const std::optional<int> line = LineOfTooManyAttributes(text);
  if (line) diagnostics.Error({file, *line}, TooMany(kMaxElementAttributes, "attributes of one element"));
  return !line;
}

bool IsModelCount(const XMLElement& root, const std::string& file, Diagnostics& diagnostics) {
  std::map<std::string_view, int> counts;
  int in_worlds = 0;
  const auto is_below = [&](int count, int most, const std::string& what, const XMLElement& element) {
    if (count <= most) return true;
    diagnostics.Error({file, element.GetLineNum()}, TooMany(most, what));
    return false;
  };
  const std::function<bool(const XMLElement&)> count = [&](const XMLElement& element) {
    const std::string name = element.Name();
    if (!is_below(++counts["elements"], kMaxModelElements, "elements", element)) return false;
    const bool is_part = name == "link" || name == "joint" || name == "frame";
    if (is_part && !is_below(++counts[element.Name()], kMaxModelParts, name + "s", element)) return false;
    const XMLElement* parent = element.Parent() == nullptr ? nullptr : element.Parent()->ToElement();
    const bool in_world = parent != nullptr && std::string_view(parent->Name()) == "world";
    if (in_world) {  // the limits apply to each model of a world; a separate one to all together
      in_worlds += counts["elements"];
      counts.clear();
      if (!is_below(in_worlds, kMaxWorldElements, "elements", element)) return false;
    }
    for (const XMLElement* child = element.FirstChildElement(); child != nullptr;
         child = child->NextSiblingElement()) {
      if (!count(*child)) return false;
    }
    return true;
  };
  return count(root);
}

void CheckSdf(const XMLElement& root, const sdf::ElementPtr& description, const std::string& file,
              Diagnostics& diagnostics) {
  const bool lenient = root.Attribute("coopdyn:foreign") != nullptr;
  Checker(file, lenient, diagnostics).Check(root, description, 0);
}

}  // namespace coopdyn
