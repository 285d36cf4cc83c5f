// SPDX-License-Identifier: MIT
// Numbers, poses and elements of SDF. Pure; any thread.
#pragma once

#include <tinyxml2.h>

#include <string>

#include "server/geometry/shape.h"

namespace coopdyn::mjcf {

/// Up to 12 digits, so that a model can be read and edited.
std::string Number(double value);
std::string Numbers(const Vector3& v);
/// x y z roll pitch yaw.
std::string PoseText(const Pose& pose);

/// A new element `name` at the end of `parent`.
tinyxml2::XMLElement& Add(tinyxml2::XMLElement& parent, const char* name, const std::string& text = {});
/// The same with the attribute name="…".
tinyxml2::XMLElement& AddNamed(tinyxml2::XMLElement& parent, const char* element, const std::string& name);
/// A <pose>, unless it is the identity.
void AddPose(tinyxml2::XMLElement& parent, const Pose& pose);

}  // namespace coopdyn::mjcf
