// SPDX-License-Identifier: MIT
// A text that is written line by line, with the line of the XML that each came from. Pure; any thread.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "server/geometry/shape.h"

namespace coopdyn::rosiml {

struct MadeText {
  std::string text;
  std::vector<int> lines;  // lines[n] is where line n + 1 was written

  void Add(int line, std::string_view what) {
    text += what;
    text += '\n';
    lines.push_back(line);
  }
};

/// The shortest decimal number that is this one; 0 for -0.
std::string Exact(double value);
/// A whole number with all its digits.
std::string Whole(double value);
/// To 1e-12: what is 0 but for rounding reads as 0.
std::string Rounded(double value);
/// x y z, rounded so.
std::string Places(const Vector3& v);
/// roll pitch yaw, in radians, about the fixed axes x, y, z.
std::string RollPitchYaw(const Quaternion& q);
/// x y z roll pitch yaw
std::string Places(const Pose& pose);

/// `name` with only letters, digits, _ and -, a letter first; at most `most` characters.
std::string Simple(std::string_view name, std::size_t most);

}  // namespace coopdyn::rosiml
