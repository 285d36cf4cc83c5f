// SPDX-License-Identifier: MIT
// The order in which a mechanism's bodies hang on each other: a spanning tree of its joints. What closes a
// loop is left over. Constant once made. Only server/physics includes this file.
#pragma once

#include <vector>

#include "server/model/robot_model.h"

namespace coopdyn {

/// A body and how it hangs on the tree. Its degrees of freedom: of a root the angular, then the linear
/// velocity of its centre of mass in W; of a ball joint the angular velocity against its parent in W; else
/// the rates of the joint's axes.
struct LimbNode {
  int body = 0;    // of the mechanism
  int parent = 0;  // node; -1: a root
  int joint = -1;  // of the model, to the parent; -1: a root
  int sign = 1;    // -1: the joint's child is the node's parent
  int dofs = 0;
};

struct LimbTree {
  std::vector<LimbNode> nodes;  // parents first
  std::vector<int> node_of;     // by body
  std::vector<int> loops;       // joints that close loops
};

/// The tree of `bodies` bodies: driven joints come first, then those that something resists, so that loops
/// are closed by free joints. `is_driven`: by joint. The first body stands still if `fixed_base`.
LimbTree MakeLimbTree(std::size_t bodies, const std::vector<JointModel>& joints,
                      const std::vector<bool>& is_driven, bool fixed_base);

}  // namespace coopdyn
