// SPDX-License-Identifier: MIT
// The target and neighbours modules: the landmarks and robots that a robot sees, and the broadcasts it hears.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "server/base/portable_math.h"
#include "server/sensing/readings.h"
#include "server/sensing/sensing_cache.h"
#include "server/state/noise.h"

namespace coopdyn {

namespace {

/// The noise kinds of one kind of sighting.
struct SightNoise {
  NoiseKind distance, bearing;
};

/// One robot looking around: code shared by both modules. `Kind`: the sensor's model, TargetModel or
/// NeighboursModel.
template <typename Kind>
class Lookout {
 public:
  /// For sensor `number`, within its kind, of robot `robot`. The frame and the model outlive it.
  Lookout(const Frame& frame, int robot, std::size_t number, const Kind& model)
      : frame_(frame),
        cache_(SensingCache::Of(frame)),
        robot_(robot),
        number_(static_cast<std::uint32_t>(number)),
        model_(model),
        self_(frame.scene->robots[static_cast<std::size_t>(robot)]),
        X_WR_(cache_.field().pose(robot)),
        heading_rad_(Heading(X_WR_.q)) {}

  const SensingCache& cache() const { return cache_; }
  const RobotField& field() const { return cache_.field(); }
  int robot() const { return robot_; }
  const SceneRobot& self() const { return self_; }
  const Kind& model() const { return model_; }
  const Pose& X_WR() const { return X_WR_; }

  /// The noisy sighting of the thing `index` at `p_W`, `distance_m` and at most `most_m` away. `id`: the
  /// thing's.
  Sighting See(int index, std::uint32_t id, const Vector3& p_W, double distance_m, double most_m,
               const SightNoise& noise) const {
    Sighting sighting{index, distance_m, 0};
    if (distance_m > 0) {
      sighting.bearing_rad =
          WrapAngle(portable::Atan2(p_W.y() - X_WR_.p.y(), p_W.x() - X_WR_.p.x()) - heading_rad_);
    }
    if (model_.distance_noise_stddev_m > 0) {
      const double noise_m = model_.distance_noise_stddev_m * GaussianNoise(Key(noise.distance, id));
      sighting.distance_m = std::clamp(sighting.distance_m + noise_m, 0.0, most_m);
    }
    if (model_.bearing_noise_stddev_rad > 0) {
      const double noise_rad = model_.bearing_noise_stddev_rad * GaussianNoise(Key(noise.bearing, id));
      sighting.bearing_rad = WrapAngle(sighting.bearing_rad + noise_rad);
    }
    return sighting;
  }

  NoiseKey Key(NoiseKind kind, std::uint32_t id) const {
    return {frame_.seed, kind, self_.id.value, id, frame_.step, number_};
  }

 private:
  const Frame& frame_;
  const SensingCache& cache_;
  const int robot_;
  const std::uint32_t number_;
  const Kind& model_;
  const SceneRobot& self_;
  const Pose& X_WR_;
  const double heading_rad_;
};

// --- the target module: landmarks and other robots, seen by a camera above the robot's origin at the robot's
// full height

using Eye = Lookout<TargetModel>;

bool IsHidden(const Eye& eye, const Vector3& p_W, int robot) {
  const Vector3 eye_W = eye.X_WR() * Vector3(0, 0, eye.self().entry.model->height_m);
  const Vector3 way = p_W - eye_W;
  const double length_m = way.norm();
  if (length_m <= 0) return false;
  const ThingHit hit = eye.cache().Cast({eye_W, way / length_m}, length_m, eye.robot());
  // A hit in front of p_W may still be the robot itself.
  return hit && (robot < 0 || hit.robot != robot);
}

/// Appends a sighting of the thing `index` at `p_W` if it is in range and visible. `robot`: its index if it
/// is a robot, else -1.
void Look(const Eye& eye, int index, std::uint32_t id, const Vector3& p_W, int robot, const SightNoise& noise,
          std::vector<Sighting>& seen) {
  const double distance_m = portable::Hypot(p_W.x() - eye.X_WR().p.x(), p_W.y() - eye.X_WR().p.y());
  const double most_m = eye.model().max_range_m;
  if (distance_m > most_m) return;
  if (!eye.model().see_through && IsHidden(eye, p_W, robot)) return;
  seen.push_back(eye.See(index, id, p_W, distance_m, most_m, noise));
}

}  // namespace

std::vector<Sighting> SeenTargets(const Frame& frame, int robot, std::size_t number) {
  const auto* model = ModelOf(frame, robot).Find<TargetModel>(number);
  if (model == nullptr) return {};
  const Eye eye(frame, robot, number, *model);
  std::vector<Sighting> seen;
  const std::vector<Target>& targets = frame.scene->targets;
  seen.reserve(targets.size());
  for (std::size_t i = 0; i < targets.size(); ++i) {
    Look(eye, static_cast<int>(i), targets[i].id.value, targets[i].p_WT, -1,
         {NoiseKind::kTargetDistance, NoiseKind::kTargetBearing}, seen);
  }
  return seen;
}

std::vector<Sighting> SeenRobots(const Frame& frame, int robot, std::size_t number) {
  const auto* model = ModelOf(frame, robot).Find<TargetModel>(number);
  if (model == nullptr) return {};
  const Eye eye(frame, robot, number, *model);
  std::vector<Sighting> seen;
  const std::vector<SceneRobot>& robots = frame.scene->robots;
  for (int other = 0; other < static_cast<int>(robots.size()); ++other) {
    if (other == robot) continue;
    const SceneRobot& scene_robot = robots[static_cast<std::size_t>(other)];
    // The centre of the body; in the plane it is the robot's origin unless the robot tilts.
    Vector3 p_W = eye.field().pose(other).p;
    p_W.z() += scene_robot.entry.model->height_m / 2;
    Look(eye, other, scene_robot.id.value, p_W, other, {NoiseKind::kRobotDistance, NoiseKind::kRobotBearing},
         seen);
  }
  return seen;
}

namespace {

// --- the neighbours module: nearby robots and their broadcasts

constexpr SightNoise kNeighbourNoise{NoiseKind::kNeighbourDistance, NoiseKind::kNeighbourBearing};

/// A robot that senses other robots.
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

  /// The noisy sighting of `other`, at most `range_m` away.
  Sighting Look(int other, double range_m) const {
    const Vector3& p_W = field().pose(other).p;
    return See(other, IdOf(other), p_W, Distance(p_W.x(), p_W.y()), range_m, kNeighbourNoise);
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

/// The broadcasts sent `delay_steps` steps before `frame`, by sender.
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
  // Fast path: in a swarm every robot sends.
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
