// SPDX-License-Identifier: MIT
// Formats SDF numbers and poses, and adds SDF elements. Pure; any thread.
#pragma once

#include <tinyxml2.h>

#include <string>

#include "server/geometry/shape.h"

namespace coopdyn::mjcf {

/// Up to 12 digits, so that people can read and edit the model.
std::string Number(double value);
std::string Numbers(const Vector3& v);
/// "x y z roll pitch yaw".
std::string PoseText(const Pose& pose);

/// Adds an element `name` at the end of `parent`.
tinyxml2::XMLElement& Add(tinyxml2::XMLElement& parent, const char* name, const std::string& text = {});
/// The same with the attribute name="…".
tinyxml2::XMLElement& AddNamed(tinyxml2::XMLElement& parent, const char* element, const std::string& name);
/// Adds a <pose>, unless it is the identity.
void AddPose(tinyxml2::XMLElement& parent, const Pose& pose);

}  // namespace coopdyn::mjcf
