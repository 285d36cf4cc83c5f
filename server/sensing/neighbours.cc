// SPDX-License-Identifier: MIT
// The neighbours module: who is near, and what they broadcast.
#include <algorithm>
#include <cmath>

#include "server/sensing/noise.h"
#include "server/sensing/readings.h"
#include "server/sensing/sensing_cache.h"

namespace coopdyn {

namespace {

/// One robot looking around.
class Lookout {
 public:
  Lookout(const Frame& frame, int robot)
      : frame_(frame),
        field_(SensingCache::Of(frame).field()),
        robot_(robot),
        self_(frame.scene->robots[static_cast<std::size_t>(robot)]),
        X_WR_(field_.pose(robot)),
        heading_rad_(Heading(X_WR_.q)) {}

  const NeighboursModel& model() const { return self_.entry.model->neighbours; }

  /// Calls visit(robot) for every other robot within `range_m`, in no particular order.
  template <typename Visit>
  void ForNear(double range_m, Visit visit) const {
    field_.ForCenters(X_WR_.p.x(), X_WR_.p.y(), range_m, [&](auto entries) {
      for (const RobotField::Entry& entry : entries) {
        if (entry.robot != robot_ && Distance(entry.x, entry.y) <= range_m) visit(entry.robot);
      }
    });
  }

  bool IsNear(int other, double range_m) const {
    const Vector3& p_W = field_.pose(other).p;
    return Distance(p_W.x(), p_W.y()) <= range_m;
  }

  /// `other` as read, with noise, at most `range_m` away.
  Sighting Look(int other, double range_m) const {
    const Vector3& p_W = field_.pose(other).p;
    Sighting sighting{other, Distance(p_W.x(), p_W.y()), 0};
    if (sighting.distance_m > 0) {
      sighting.bearing_rad =
          WrapAngle(std::atan2(p_W.y() - X_WR_.p.y(), p_W.x() - X_WR_.p.x()) - heading_rad_);
    }
    if (model().distance_noise_stddev_m > 0) {
      const double noise_m =
          model().distance_noise_stddev_m * GaussianNoise(Key(NoiseKind::kNeighbourDistance, other));
      sighting.distance_m = std::clamp(sighting.distance_m + noise_m, 0.0, range_m);
    }
    if (model().bearing_noise_stddev_rad > 0) {
      const double noise_rad =
          model().bearing_noise_stddev_rad * GaussianNoise(Key(NoiseKind::kNeighbourBearing, other));
      sighting.bearing_rad = WrapAngle(sighting.bearing_rad + noise_rad);
    }
    return sighting;
  }

  bool IsLost(int sender) const {
    return model().loss > 0 && UniformNoise(Key(NoiseKind::kMessageLoss, sender)) < model().loss;
  }

 private:
  double Distance(double x, double y) const {
    const double dx = x - X_WR_.p.x(), dy = y - X_WR_.p.y();
    return std::sqrt(dx * dx + dy * dy);
  }
  NoiseKey Key(NoiseKind kind, int other) const {
    const RobotId id = frame_.scene->robots[static_cast<std::size_t>(other)].id;
    return {frame_.seed, kind, self_.id.value, id.value, frame_.step, 0};
  }

  const Frame& frame_;
  const RobotField& field_;
  const int robot_;
  const SceneRobot& self_;
  const Pose& X_WR_;
  const double heading_rad_;
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

void AppendNeighbours(const Frame& frame, int robot, std::vector<Sighting>& seen) {
  const NeighboursModel& model = frame.scene->robots[static_cast<std::size_t>(robot)].entry.model->neighbours;
  if (model.range_m <= 0) return;
  const Lookout lookout(frame, robot);
  const auto first = static_cast<std::ptrdiff_t>(seen.size());
  lookout.ForNear(model.range_m, [&](int other) { seen.push_back(lookout.Look(other, model.range_m)); });
  std::sort(seen.begin() + first, seen.end(),
            [](const Sighting& a, const Sighting& b) { return a.index < b.index; });
}

std::vector<Sighting> Neighbours(const Frame& frame, int robot) {
  std::vector<Sighting> seen;
  AppendNeighbours(frame, robot, seen);
  return seen;
}

void AppendHeard(const Frame& frame, int robot, std::vector<HeardMessage>& heard) {
  const NeighboursModel& model = frame.scene->robots[static_cast<std::size_t>(robot)].entry.model->neighbours;
  if (model.message_range_m <= 0 || frame.messages.empty()) return;
  const Messages messages = SentBefore(frame, model.delay_steps);
  if (messages.empty()) return;
  const Lookout lookout(frame, robot);
  const auto first = static_cast<std::ptrdiff_t>(heard.size());
  const auto hear = [&](const SentMessage& sent) {
    const int sender = static_cast<int>(sent.robot);
    if (sent.message.count == 0 || lookout.IsLost(sender)) return;
    heard.push_back({sender, lookout.Look(sender, model.message_range_m), &sent.message});
  };
  constexpr std::size_t kFew = 8;
  if (messages.size() <= kFew) {
    for (const SentMessage& sent : messages) {
      const int sender = static_cast<int>(sent.robot);
      if (sender != robot && lookout.IsNear(sender, model.message_range_m)) hear(sent);
    }
    return;
  }
  lookout.ForNear(model.message_range_m, [&](int other) {
    if (const SentMessage* sent = FindMessage(messages, other)) hear(*sent);
  });
  std::sort(heard.begin() + first, heard.end(),
            [](const HeardMessage& a, const HeardMessage& b) { return a.sender < b.sender; });
}

std::vector<HeardMessage> HeardMessages(const Frame& frame, int robot) {
  std::vector<HeardMessage> heard;
  AppendHeard(frame, robot, heard);
  return heard;
}

}  // namespace coopdyn
