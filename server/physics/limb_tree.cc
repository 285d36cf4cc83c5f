// SPDX-License-Identifier: MIT
#include "server/physics/limb_tree.h"

#include <algorithm>
#include <numeric>

namespace coopdyn {

namespace {

int DofsOf(const JointModel& joint) {
  switch (joint.kind) {
    case JointModel::Kind::kBall:
      return 3;
    case JointModel::Kind::kUniversal:
      return 2;
    default:
      return 1;
  }
}

/// Priority of a joint for the tree.
int RankOf(const JointModel& joint, bool is_driven) {
  if (is_driven) return 3;
  return joint.is_resisted() || joint.has_stop() ? 2 : joint.has_axis() ? 1 : 0;
}

/// Returns the joints of a spanning forest; the other joints go to `loops`.
std::vector<int> Span(std::size_t bodies, const std::vector<JointModel>& joints,
                      const std::vector<bool>& is_driven, std::vector<int>& loops) {
  std::vector<int> order(joints.size()), group(bodies);
  std::iota(order.begin(), order.end(), 0);
  std::iota(group.begin(), group.end(), 0);
  const auto rank = [&](int joint) {
    const auto index = static_cast<std::size_t>(joint);
    return -RankOf(joints[index], is_driven[index]);
  };
  std::ranges::stable_sort(order, {}, rank);
  std::vector<int> spanning;
  for (const int index : order) {
    const JointModel& joint = joints[static_cast<std::size_t>(index)];
    if (!joint.joins()) continue;
    const int a = group[static_cast<std::size_t>(joint.parent)],
              b = group[static_cast<std::size_t>(joint.child)];
    (a == b ? loops : spanning).push_back(index);
    std::ranges::replace(group, b, a);
  }
  std::ranges::sort(spanning);
  std::ranges::sort(loops);
  return spanning;
}

}  // namespace

LimbTree MakeLimbTree(std::size_t bodies, const std::vector<JointModel>& joints,
                      const std::vector<bool>& is_driven, bool fixed_base) {
  LimbTree tree;
  tree.node_of.assign(bodies, -1);
  const std::vector<int> spanning = Span(bodies, joints, is_driven, tree.loops);
  const auto add = [&](int body, LimbNode node) {
    node.body = body;
    tree.node_of[static_cast<std::size_t>(body)] = static_cast<int>(tree.nodes.size());
    tree.nodes.push_back(node);
  };
  // Depth first, so that the degrees of freedom of a limb are adjacent.
  const auto grow = [&](auto&& self, int body) -> void {
    const int parent = tree.node_of[static_cast<std::size_t>(body)];
    for (const int index : spanning) {
      const JointModel& joint = joints[static_cast<std::size_t>(index)];
      const bool down = joint.parent == body;
      const int next = down ? joint.child : joint.parent;
      if ((!down && joint.child != body) || tree.node_of[static_cast<std::size_t>(next)] >= 0) continue;
      add(next, {0, parent, index, down ? 1 : -1, DofsOf(joint)});
      self(self, next);
    }
  };
  for (std::size_t body = 0; body < bodies; ++body) {
    if (tree.node_of[body] >= 0) continue;
    add(static_cast<int>(body), {0, -1, -1, 1, fixed_base && body == 0 ? 0 : 6});
    grow(grow, static_cast<int>(body));
  }
  return tree;
}

}  // namespace coopdyn
