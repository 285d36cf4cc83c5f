// SPDX-License-Identifier: MIT
#include "server/mjcf/sdf_text.h"

#include <array>
#include <charconv>
#include <cmath>

namespace coopdyn::mjcf {

std::string Number(double value) {
  // Rounding error of rotations by 90 degrees.
  if (std::abs(value) < 1e-14) return "0";
  std::array<char, 40> text{};
  const auto end =
      std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::general, 12);
  return {text.data(), end.ptr};
}

std::string Numbers(const Vector3& v) {
  return Number(v.x()) + " " + Number(v.y()) + " " + Number(v.z());
}

std::string PoseText(const Pose& pose) {
  return Numbers(pose.p) + " " + Numbers(ToRollPitchYaw(pose.q));
}

tinyxml2::XMLElement& Add(tinyxml2::XMLElement& parent, const char* name, const std::string& text) {
  tinyxml2::XMLElement* const made = parent.InsertNewChildElement(name);
  if (!text.empty()) made->SetText(text.c_str());
  return *made;
}

tinyxml2::XMLElement& AddNamed(tinyxml2::XMLElement& parent, const char* element, const std::string& name) {
  tinyxml2::XMLElement& made = Add(parent, element);
  made.SetAttribute("name", name.c_str());
  return made;
}

void AddPose(tinyxml2::XMLElement& parent, const Pose& pose) {
  const std::string text = PoseText(pose);
  if (text != "0 0 0 0 0 0") Add(parent, "pose", text);
}

}  // namespace coopdyn::mjcf
