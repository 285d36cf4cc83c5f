// SPDX-License-Identifier: MIT
// The neighbours module: who is near, and what they broadcast.
#include <algorithm>
#include <cmath>

#include "server/sensing/lookout.h"

namespace coopdyn {

namespace {

constexpr SightNoise kNoise{NoiseKind::kNeighbourDistance, NoiseKind::kNeighbourBearing};

/// A robot that senses others.
class Receiver : public Lookout<NeighboursModel> {
 public:
  using Lookout::Lookout;

  /// Calls visit(robot) for every other robot within `range_m`, in no particular order.
  template <typename Visit>
  void ForNear(double range_m, Visit visit) const {
    field().ForCenters(X_WR().p.x(), X_WR().p.y(), range_m, [&](auto entries) {
      for (const RobotField::Entry& entry : entries) {
        if (entry.robot != robot() && Distance(entry.x, entry.y) <= range_m) visit(entry.robot);
      }
    });
  }

  bool IsNear(int other, double range_m) const {
    const Vector3& p_W = field().pose(other).p;
    return Distance(p_W.x(), p_W.y()) <= range_m;
  }

  /// `other` as read, with noise, at most `range_m` away.
  Sighting Look(int other, double range_m) const {
    const Vector3& p_W = field().pose(other).p;
    return See(other, IdOf(other), p_W, Distance(p_W.x(), p_W.y()), range_m, kNoise);
  }

  bool IsLost(int sender) const {
    const double loss = model().loss;
    return loss > 0 && UniformNoise(Key(NoiseKind::kMessageLoss, IdOf(sender))) < loss;
  }

 private:
  double Distance(double x, double y) const {
    const double dx = x - X_WR().p.x(), dy = y - X_WR().p.y();
    return std::sqrt(dx * dx + dy * dy);
  }
  std::uint32_t IdOf(int other) const {
    return cache().frame().scene->robots[static_cast<std::size_t>(other)].id.value;
  }
};

using Messages = std::span<const SentMessage>;

/// The broadcasts that were sent `delay_steps` before `frame`, by sender.
Messages SentBefore(const Frame& frame, int delay_steps) {
  const auto delay = static_cast<std::uint64_t>(delay_steps);
  if (frame.step < delay) return {};
  const std::uint64_t step = frame.step - delay;
  const auto before = [](const SentMessage& message, std::uint64_t wanted) { return message.step < wanted; };
  const auto first = std::lower_bound(frame.messages.begin(), frame.messages.end(), step, before);
  const auto end = std::lower_bound(first, frame.messages.end(), step + 1, before);
  return {first, end};
}

/// The message of `sender`; null if it sent none.
const SentMessage* FindMessage(Messages messages, int sender) {
  const auto index = static_cast<std::uint32_t>(sender);
  // In a swarm all send.
  if (index < messages.size() && messages[index].robot == index) return &messages[index];
  const auto found = std::lower_bound(
      messages.begin(), messages.end(), index,
      [](const SentMessage& message, std::uint32_t wanted) { return message.robot < wanted; });
  return found != messages.end() && found->robot == index ? &*found : nullptr;
}

}  // namespace

std::vector<Sighting> Neighbours(const Frame& frame, int robot, std::size_t number) {
  const auto* model = ModelOf(frame, robot).Find<NeighboursModel>(number);
  if (model == nullptr) return {};
  const Receiver receiver(frame, robot, number, *model);
  std::vector<Sighting> seen;
  receiver.ForNear(model->range_m, [&](int other) { seen.push_back(receiver.Look(other, model->range_m)); });
  std::sort(seen.begin(), seen.end(), [](const Sighting& a, const Sighting& b) { return a.index < b.index; });
  return seen;
}

std::vector<HeardMessage> HeardMessages(const Frame& frame, int robot, std::size_t number) {
  const auto* model = ModelOf(frame, robot).Find<NeighboursModel>(number);
  if (model == nullptr || model->message_range_m <= 0 || frame.messages.empty()) return {};
  const Messages messages = SentBefore(frame, model->delay_steps);
  if (messages.empty()) return {};
  const Receiver receiver(frame, robot, number, *model);
  std::vector<HeardMessage> heard;
  const auto hear = [&](const SentMessage& sent) {
    const int sender = static_cast<int>(sent.robot);
    if (sent.message.count == 0 || receiver.IsLost(sender)) return;
    heard.push_back({sender, receiver.Look(sender, model->message_range_m), &sent.message});
  };
  constexpr std::size_t kFew = 8;
  if (messages.size() <= kFew) {
    for (const SentMessage& sent : messages) {
      const int sender = static_cast<int>(sent.robot);
      if (sender != robot && receiver.IsNear(sender, model->message_range_m)) hear(sent);
    }
    return heard;
  }
  receiver.ForNear(model->message_range_m, [&](int other) {
    if (const SentMessage* sent = FindMessage(messages, other)) hear(*sent);
  });
  std::sort(heard.begin(), heard.end(),
            [](const HeardMessage& a, const HeardMessage& b) { return a.sender < b.sender; });
  return heard;
}

}  // namespace coopdyn
