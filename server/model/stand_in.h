// SPDX-License-Identifier: MIT
// The shape that collides in place of a link's missing meshes. One thread.
#pragma once

#include <optional>

#include "server/model/xml_tree.h"

namespace coopdyn {

/// A box with a link's mass and moments of inertia.
class StandIn {
 public:
  /// The box of `link`; nullopt if the link has no mass or moments.
  static std::optional<StandIn> Of(const XmlNode& link);

  /// Gives `collision` this box. False if the link already has the box; the caller must then remove
  /// `collision`.
  bool PutInto(XmlNode& collision);

 private:
  XmlNode shape_;
  std::optional<XmlNode> pose_;
  bool is_used_ = false;
};

}  // namespace coopdyn
