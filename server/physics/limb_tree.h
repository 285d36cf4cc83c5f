// SPDX-License-Identifier: MIT
// The tree of a mechanism's bodies: a spanning tree of its joints. Joints that close loops are listed
// separately. Immutable. Only server/physics includes this file.
#pragma once

#include <vector>

#include "server/model/robot_model.h"

namespace coopdyn {

/// A body and its place in the tree. Its degrees of freedom are: for a root, the angular velocity, then the
/// linear velocity of its centre of mass, in W; for a ball joint, the angular velocity relative to its
/// parent, in W; else the rates of the joint's axes.
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

/// Makes the tree of `bodies` bodies. Prefers driven joints, then joints with resistance or stops, so that
/// free joints close the loops. `is_driven`: by joint. If `fixed_base`, the first body stands still.
LimbTree MakeLimbTree(std::size_t bodies, const std::vector<JointModel>& joints,
                      const std::vector<bool>& is_driven, bool fixed_base);

}  // namespace coopdyn
