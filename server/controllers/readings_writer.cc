// SPDX-License-Identifier: MIT
#include "server/controllers/readings_writer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <functional>
#include <latch>

#include "server/base/portable_math.h"
#include "server/sensing/readings.h"
#include "server/state/controller_driver.h"
#include "server/state/world_change.h"

namespace coopdyn {

namespace {

constexpr std::size_t kPicturesAtOnce = ImageBoard::kMaxWaiting / 2;  // leaves room for other requests
constexpr std::size_t kListedGrain = 256;  // robots that a thread fetches at a time
constexpr std::size_t kFixedGrain = 4096;  // without lists there is hardly any work
constexpr std::uint32_t kListed = COOPDYN_TARGETS | COOPDYN_NEIGHBOURS | COOPDYN_MESSAGES | COOPDYN_WORLD;

coopdyn_sighting FromSighting(const Sighting& sighting, const Frame& frame) {
  return {frame.scene->robots[static_cast<std::size_t>(sighting.index)].id.value, sighting.distance_m,
          sighting.bearing_rad};
}

/// Orientation of R in the world, and its velocities along its own axes.
void WriteMotion(const Frame& frame, int robot, RobotReadings& readings) {
  const Pose X_WR = RobotPose(frame, robot);
  const Twist twist = OriginTwist(frame, robot, X_WR);
  const Matrix3 R_WR = X_WR.q.toRotationMatrix();
  const Vector3 v_R = R_WR.transpose() * twist.v_W, w_R = R_WR.transpose() * twist.w_W;
  readings.height_m = X_WR.p.z();
  readings.heading_rad = Heading(X_WR.q);
  readings.roll_rad = portable::Atan2(R_WR(2, 1), R_WR(2, 2));
  readings.pitch_rad = portable::Asin(std::clamp(-R_WR(2, 0), -1.0, 1.0));
  std::copy_n(v_R.data(), 3, readings.velocity_m_s);
  std::copy_n(w_R.data(), 3, readings.angular_velocity_rad_s);
}

/// Copies `name` into `field`, truncated if it does not fit.
void SetName(char (&field)[COOPDYN_MAX_NAME], const std::string& name) {
  name.copy(field, COOPDYN_MAX_NAME - 1);
}

void SetPose(const Pose& X_WB, coopdyn_body& body) {
  std::copy_n(X_WB.p.data(), 3, body.pose.p_m);
  const std::array q{X_WB.q.w(), X_WB.q.x(), X_WB.q.y(), X_WB.q.z()};
  std::ranges::copy(q, body.pose.q);
}

void SetTwist(const Vector3& v_W, const Vector3& w_W, coopdyn_body& body) {
  std::copy_n(v_W.data(), 3, body.velocity_m_s);
  std::copy_n(w_W.data(), 3, body.angular_velocity_rad_s);
}

/// Writes the values of the robot's channel if this step begins an exchange.
void WriteMappedValues(const Frame& frame, int robot, const Areas& areas, const RobotSetup& setup) {
  if (frame.step % setup.exchange_steps != 0) return;
  std::vector<double> values;
  AppendChannelValues(frame, robot, 0, values);
  std::copy_n(values.begin(), std::min(values.size(), setup.robot.mapped_count),
              areas.in.At<double>(setup.mapped));
}

coopdyn_body BodyOf(std::int32_t id, coopdyn_kind kind, const std::string& name, const Pose& X_WB) {
  coopdyn_body body{};
  body.id = static_cast<std::uint32_t>(id);
  body.kind = kind;
  SetName(body.name, name);
  SetPose(X_WB, body);
  return body;
}

}  // namespace

std::string ReadingsWriter::Write(const FramePtr& now, std::span<const ReadingsWanted> wanted,
                                  ControllerSet& set) {
  const Frame& frame = *now;
  robots_.clear();
  bool listed = false;
  for (const ReadingsWanted& one : wanted) {
    if ((one.readings & COOPDYN_DISTANCES) != 0) robots_.push_back(one.robot);
    listed = listed || (one.readings & kListed) != 0;
  }
  if (!robots_.empty()) PrepareDistances(frame, robots_, pool_);
  if (lists_.size() < wanted.size()) lists_.resize(wanted.size());
  const Areas& areas = set.areas();
  const auto work = [&](std::size_t first, std::size_t end) {
    for (std::size_t i = first; i < end; ++i) {
      WriteFixed(frame, wanted[i], areas);
      if (listed) Collect(frame, wanted[i], lists_[i]);
    }
  };
  // By reference: a std::function with these captures would allocate.
  pool_.For(wanted.size(), listed ? kListedGrain : kFixedGrain, std::cref(work));
  bodies_.clear();
  scores_.clear();
  if (!wanted.empty() && wanted.front().robot == kSupervisor) CollectWorld(frame);
  if (listed) PlaceLists(wanted, set);
  const bool sensing = std::ranges::any_of(wanted, [](const auto& one) { return !one.sensors.empty(); });
  return sensing ? WritePictures(now, wanted, set.areas()) : std::string();
}

void ReadingsWriter::WriteSensors(const Frame& frame, const ReadingsWanted& wanted, const Areas& areas) {
  const RobotSetup& setup = areas.setup(wanted.slot);
  const RobotModel& model = ModelOf(frame, wanted.robot);
  for (std::size_t i = 0; i < wanted.sensors.size(); ++i) {
    const std::size_t sensor = wanted.sensors[i];
    SensorPlace& place = areas.in.At<SensorPlace>(setup.sensed)[i];
    place.step = SampleOf(frame, wanted.robot, sensor).step;
    const std::size_t count = FixedCount(model.sensors[sensor].kind);
    FillFixed(frame, wanted.robot, sensor, {areas.in.At<double>(place.values), count});
  }
}

std::string ReadingsWriter::WritePictures(const FramePtr& frame, std::span<const ReadingsWanted> wanted,
                                          const Areas& areas) {
  pictures_.clear();
  for (const ReadingsWanted& one : wanted) {
    const RobotSetup& setup = areas.setup(one.slot);
    for (std::size_t i = 0; i < one.sensors.size(); ++i) {
      const coopdyn_sensor& facts = areas.in.At<coopdyn_sensor>(setup.sensors)[i];
      if (facts.width == 0) continue;
      const SensorPlace& place = areas.in.At<SensorPlace>(setup.sensed)[i];
      pictures_.push_back(
          {{SampleOf(frame, one.robot, one.sensors[i]), one.robot, one.sensors[i]},
           {areas.in.At<std::uint8_t>(place.image), std::size_t{3} * facts.width * facts.height}});
    }
  }
  std::string missing;
  if (draw_ && !pictures_.empty()) missing = draw_(pictures_);
  pictures_.clear();  // frees the frames
  return missing;
}

DrawPictures DrawOn(ImageBoard& images) {
  return [&images](std::span<const PictureWanted> wanted) {
    std::vector<std::string> errors(std::min(wanted.size(), kPicturesAtOnce));
    while (!wanted.empty()) {
      const std::span<const PictureWanted> some = wanted.first(std::min(wanted.size(), kPicturesAtOnce));
      std::latch left(static_cast<std::ptrdiff_t>(some.size()));
      for (std::size_t i = 0; i < some.size(); ++i) {
        ImageRequest request;
        request.shot = some[i].shot;
        request.format = ImageFormat::kRgb;
        images.Request(std::move(request), [&, i](const ImageResult& result) {
          const std::span<std::uint8_t> rgb = some[i].rgb;
          if (result.error.empty() && result.bytes->size() == rgb.size()) {
            std::ranges::copy(*result.bytes, rgb.begin());
          } else {
            std::ranges::fill(rgb, std::uint8_t{0});
            errors[i] = result.error;
          }
          left.count_down();
        });
      }
      left.wait();
      wanted = wanted.subspan(some.size());
    }
    const auto first = std::ranges::find_if(errors, [](const auto& error) { return !error.empty(); });
    return first == errors.end() ? std::string() : *first;
  };
}

void ReadingsWriter::WriteFixed(const Frame& frame, const ReadingsWanted& wanted, const Areas& areas) const {
  RobotReadings& readings = areas.readings(wanted.slot);
  readings = {};
  if ((wanted.readings & COOPDYN_DISTANCES) != 0) {
    const std::span<const double> distances = Distances(frame, wanted.robot);
    readings.distance_count = distances.size();
    std::copy(distances.begin(), distances.end(), areas.in.At<double>(areas.setup(wanted.slot).distances));
  }
  if ((wanted.readings & COOPDYN_POSE) != 0) {
    const PlaneMotion motion = MotionOf(frame, wanted.robot);
    readings.x_m = motion.x_m;
    readings.y_m = motion.y_m;
    readings.heading_rad = motion.heading_rad;
    readings.forward_m_s = motion.forward_m_s;
    readings.turn_rad_s = motion.turn_rad_s;
  }
  if ((wanted.readings & COOPDYN_MOTION) != 0) WriteMotion(frame, wanted.robot, readings);
  if ((wanted.readings & COOPDYN_COMPASS) != 0) readings.compass_rad = CompassHeading(frame, wanted.robot);
  if ((wanted.readings & COOPDYN_SUPPORT) != 0) {
    const SupportReading support = Support(frame, wanted.robot);
    readings.support_x_m = support.x_m;
    readings.support_y_m = support.y_m;
    readings.support_rad = support.angle_rad;
  }
  if (!wanted.sensors.empty()) WriteSensors(frame, wanted, areas);
  if ((wanted.readings & COOPDYN_MAPPED) != 0)
    WriteMappedValues(frame, wanted.robot, areas, areas.setup(wanted.slot));
  if ((wanted.readings & COOPDYN_CHANNELS) != 0) {
    const std::span<const ChannelState> channels = ChannelsOf(frame, wanted.robot);
    readings.channel_count = channels.size();
    std::ranges::transform(channels, areas.in.At<coopdyn_channel>(areas.setup(wanted.slot).channels),
                           [](const ChannelState& of) {
                             return coopdyn_channel{of.position, of.velocity, of.effort};
                           });
  }
}

void ReadingsWriter::Collect(const Frame& frame, const ReadingsWanted& wanted, Lists& lists) {
  lists.targets.clear();
  lists.neighbours.clear();
  lists.heard.clear();
  if ((wanted.readings & COOPDYN_TARGETS) != 0) {
    for (const Sighting& seen : SeenTargets(frame, wanted.robot)) {
      const Target& target = frame.scene->targets[static_cast<std::size_t>(seen.index)];
      lists.targets.push_back({target.id.value, seen.distance_m, seen.bearing_rad, target.color.r,
                               target.color.g, target.color.b});
    }
  }
  if ((wanted.readings & COOPDYN_NEIGHBOURS) != 0) {
    for (const Sighting& seen : Neighbours(frame, wanted.robot)) {
      lists.neighbours.push_back(FromSighting(seen, frame));
    }
  }
  if ((wanted.readings & COOPDYN_MESSAGES) != 0) {
    for (const HeardMessage& message : HeardMessages(frame, wanted.robot)) {
      coopdyn_heard heard{};
      heard.from = FromSighting(message.from, frame);
      heard.count = message.message->count;
      std::copy_n(message.message->values.begin(), heard.count, heard.values);
      lists.heard.push_back(heard);
    }
  }
}

void ReadingsWriter::CollectWorld(const Frame& frame) {
  const Scene& scene = *frame.scene;
  for (const SceneObject& thing : scene.objects) {
    const Pose X_WO = ObjectPose(frame, thing);
    bodies_.push_back(BodyOf(WorldIdOf(thing), COOPDYN_THING, thing.object.name, X_WO));
    if (thing.body < 0) continue;
    const BodyState& body = frame.bodies[static_cast<std::size_t>(thing.body)];
    SetTwist(body.v_WB + body.w_WB.cross(X_WO.p - body.p_WB), body.w_WB, bodies_.back());
  }
  for (std::size_t i = 0; i < scene.robots.size(); ++i) {
    const auto robot = static_cast<int>(i);
    const Pose X_WR = RobotPose(frame, robot);
    bodies_.push_back(BodyOf(WorldIdOf(scene.robots[i]), COOPDYN_ROBOT, scene.robots[i].entry.name, X_WR));
    const Twist twist = OriginTwist(frame, robot, X_WR);
    SetTwist(twist.v_W, twist.w_W, bodies_.back());
  }
  for (const Target& target : scene.targets) {
    const Pose X_WT{target.p_WT, Quaternion::Identity()};
    bodies_.push_back(BodyOf(WorldIdOf(target), COOPDYN_TARGET, TargetName(target), X_WT));
  }
  for (std::size_t i = 0; i < scene.lights.size(); ++i) {
    const Pose X_WP{scene.lights[i].p_WP, Quaternion::Identity()};
    bodies_.push_back(BodyOf(LightId(i), COOPDYN_LIGHT, scene.lights[i].name, X_WP));
  }
  for (std::size_t i = 0; i < frame.scores.size(); ++i) {
    coopdyn_score score{};
    SetName(score.name, scene.scenario->scores[i].name);
    score.value = frame.scores[i].value;
    score.met = frame.scores[i].met ? 1 : 0;
    scores_.push_back(score);
  }
}

void ReadingsWriter::PlaceLists(std::span<const ReadingsWanted> wanted, ControllerSet& set) {
  Areas& areas = set.areas();
  Layout layout(set.readings_end());
  InHeader& header = areas.header();
  header.body_count = bodies_.size();
  header.bodies = layout.Add<coopdyn_body>(bodies_.size());
  header.score_count = scores_.size();
  header.scores = layout.Add<coopdyn_score>(scores_.size());
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    RobotReadings& one = areas.readings(wanted[i].slot);
    one.target_count = lists_[i].targets.size();
    one.targets = layout.Add<coopdyn_target>(one.target_count);
    one.neighbour_count = lists_[i].neighbours.size();
    one.neighbours = layout.Add<coopdyn_sighting>(one.neighbour_count);
    one.heard_count = lists_[i].heard.size();
    one.heard = layout.Add<coopdyn_heard>(one.heard_count);
  }
  // Grow by more than needed, so that growing is rare.
  if (layout.end() > areas.in.bytes()) areas.Grow(2 * layout.end(), 0);
  const auto copy = [&areas](const auto& list, Place place) {
    if (!list.empty()) std::memcpy(areas.in.At<std::byte>(place), list.data(), list.size() * sizeof(list[0]));
  };
  copy(bodies_, areas.header().bodies);
  copy(scores_, areas.header().scores);
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    const RobotReadings& one = areas.readings(wanted[i].slot);
    copy(lists_[i].targets, one.targets);
    copy(lists_[i].neighbours, one.neighbours);
    copy(lists_[i].heard, one.heard);
  }
}

}  // namespace coopdyn
