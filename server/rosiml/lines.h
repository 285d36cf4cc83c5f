// SPDX-License-Identifier: MIT
// A generated text that records the XML line behind each of its lines. Pure; any thread.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "server/geometry/shape.h"

namespace coopdyn::rosiml {

struct MadeText {
  std::string text;
  std::vector<int> lines;  // lines[n] is the XML line of line n + 1

  void Add(int line, std::string_view what) {
    text += what;
    text += '\n';
    lines.push_back(line);
  }
};

/// The shortest decimal that reads back as `value`; 0 for -0.
std::string Exact(double value);
/// An integer with all its digits.
std::string Whole(double value);
/// Rounded to 1e-12, so that rounding errors print as 0.
std::string Rounded(double value);
/// "x y z", each Rounded().
std::string Places(const Vector3& v);
/// "roll pitch yaw" about the fixed axes x, y, z, rad.
std::string RollPitchYaw(const Quaternion& q);
/// "x y z roll pitch yaw".
std::string Places(const Pose& pose);

/// `name` reduced to at most `most` letters, digits, _ and -, starting with a letter.
std::string Simple(std::string_view name, std::size_t most);

}  // namespace coopdyn::rosiml
