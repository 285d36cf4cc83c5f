// SPDX-License-Identifier: MIT
// What collides instead of the meshes of a link that are not there. One thread.
#pragma once

#include <optional>

#include "server/model/xml_tree.h"

namespace coopdyn {

/// The box of a link's mass and moments.
class StandIn {
 public:
  /// Nothing for a link without these.
  static std::optional<StandIn> Of(const XmlNode& link);

  /// Makes `collision` this box; false if it goes, as its link has that box already.
  bool PutInto(XmlNode& collision);

 private:
  XmlNode shape_;
  std::optional<XmlNode> pose_;
  bool is_used_ = false;
};

}  // namespace coopdyn
