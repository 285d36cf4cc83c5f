// SPDX-License-Identifier: MIT
#include "server/physics/measures.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>
#include <type_traits>
#include <variant>

#include "server/base/portable_math.h"
#include "server/physics/rest.h"
#include "server/state/noise.h"

namespace coopdyn {

namespace {

/// Which body of a robot a link belongs to.
std::size_t BodyOf(const SceneRobot& robot, int link) {
  return robot.one_body() ? 0 : static_cast<std::size_t>(link);
}

Quaternion TurnBack(const BodyState& body, double dt_s) {
  const Vector3 turn = -body.w_WB * dt_s;
  const double angle_rad = turn.norm();
  if (!(angle_rad > 0)) return Quaternion::Identity();
  return portable::AngleAxis(angle_rad, turn / angle_rad);
}

void Write(const Vector3& v, std::span<double> values) {
  std::copy_n(v.data(), 3, values.begin());
}

}  // namespace

void Measures::Fit(const Scene& scene, const Things& things) {
  scene_ = &scene;
  things_ = &things;
  robots_.clear();
  wants_.clear();
  wants_work_.clear();
  work_j_.assign(scene.channels.size(), 0.0);
  flight_.clear();
  for (std::size_t i = 0; i < scene.robots.size(); ++i) {
    const SceneRobot& robot = scene.robots[i];
    const RobotModel& model = *robot.entry.model;
    Measured of;
    of.robot = static_cast<int>(i);
    of.thing = static_cast<std::uint32_t>(things.first_robot + i);
    bool wants_contacts = false;
    for (std::size_t sensor = 0; sensor < model.sensors.size(); ++sensor) {
      const SensorKind& kind = model.sensors[sensor].kind;
      const bool is_contact = std::holds_alternative<ContactModel>(kind);
      wants_contacts |= is_contact || std::holds_alternative<WrenchModel>(kind);
      if (MeasuredCount(kind) == 0 && !is_contact) continue;
      of.sensors.push_back({&kind,
                            static_cast<std::size_t>(robot.first_measured) + model.FirstMeasured(sensor),
                            static_cast<std::uint32_t>(model.NumberOf(sensor) + 1)});
    }
    if (of.sensors.empty()) continue;
    robots_.push_back(std::move(of));
    const auto* channel = model.Find<ChannelModel>();
    if (model.Find<BatteryModel>() != nullptr ||
        (channel != nullptr && std::ranges::any_of(channel->values, &ChannelModel::Value::sums_work))) {
      wants_work_.resize(things.first_static);
      wants_work_[robots_.back().thing] = 1;
    }
    if (!wants_contacts) continue;
    flight_.resize(things.first_static);
    wants_.resize(things.first_static);
    wants_[robots_.back().thing] = 1;
  }
  if (CountsCollisions(*scene.scenario)) wants_.assign(things.first_static, 1);
  thing_of_object_.assign(scene.objects.size(), MeasuredContact::kFloor);
  for (std::size_t i = 0; i < things.all.size(); ++i) {
    if (things.all[i].object >= 0)
      thing_of_object_[static_cast<std::size_t>(things.all[i].object)] = static_cast<std::uint32_t>(i);
  }
  values_ = StartValues();
  contacts_.clear();
  gathered_.clear();
}

std::vector<double> Measures::StartValues() const {
  std::vector<double> values(static_cast<std::size_t>(scene_->measured_count));
  for (const Measured& of : robots_) {
    for (const Sensor& sensor : of.sensors) {
      if (const auto* battery = std::get_if<BatteryModel>(sensor.kind)) {
        values[sensor.first] = battery->start * battery->capacity_j;
        values[sensor.first + 1] = battery->idle_w;
      }
    }
  }
  return values;
}

void Measures::Restore(const Frame& frame) {
  const bool has_values = frame.measured.size() == static_cast<std::size_t>(scene_->measured_count);
  values_ = has_values ? frame.measured : StartValues();
  contacts_ = frame.contacts;
  gathered_.clear();
}

void Measures::Begin(std::span<const BodyState> bodies) {
  for (Measured& of : robots_) {
    const SceneRobot& robot = scene_->robots[static_cast<std::size_t>(of.robot)];
    const auto own = bodies.subspan(static_cast<std::size_t>(robot.first_body),
                                    static_cast<std::size_t>(robot.body_count));
    of.before.assign(own.begin(), own.end());
  }
  std::ranges::fill(work_j_, 0.0);
  std::ranges::fill(flight_, 0.0);
  gathered_.clear();
}

void Measures::Add(std::span<const MeasuredContact> contacts, double share) {
  std::uint32_t index = 0;
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const bool again = i > 0 && contacts[i - 1].a == contacts[i].a && contacts[i - 1].b == contacts[i].b &&
                       contacts[i - 1].part_a == contacts[i].part_a &&
                       contacts[i - 1].part_b == contacts[i].part_b;
    index = again ? index + 1 : 0;
    gathered_.push_back({contacts[i], index, share});
    gathered_.back().contact.force_W *= share;
  }
}

ContactEnd Measures::EndOf(std::uint32_t thing, const Part* part) const {
  if (thing == MeasuredContact::kFloor) return {};
  const Thing& of = things_->all[thing];
  if (of.robot < 0) return {.object = of.object};
  return {-1, of.robot, part->link, part->collision};
}

bool Measures::Sleeps(const ContactEnd& end, std::span<const BodyState> bodies) const {
  if (end.robot < 0 && end.object < 0) return true;
  const std::uint32_t thing = end.robot >= 0 ? static_cast<std::uint32_t>(things_->first_robot) +
                                                   static_cast<std::uint32_t>(end.robot)
                                             : thing_of_object_[static_cast<std::size_t>(end.object)];
  if (thing >= things_->first_static) return true;
  return bodies[static_cast<std::size_t>(things_->all[thing].first_body)].sleep_counter >= kAsleep;
}

void Measures::EndContacts(std::span<const BodyState> bodies) {
  // Contacts between sleepers keep their forces.
  std::erase_if(contacts_, [&](const Contact& contact) {
    return !Sleeps(contact.a, bodies) || !Sleeps(contact.b, bodies);
  });
  const auto ends = [](const Contact& contact) {
    const ContactEnd &a = contact.a, &b = contact.b;
    return std::tuple(a.robot, a.object, a.link, a.collision, b.robot, b.object, b.link, b.collision);
  };
  struct Found {
    Contact contact;
    std::uint32_t index;
    double share;
  };
  std::vector<Found> all;
  all.reserve(gathered_.size());
  for (const AddedContact& gathered : gathered_) {
    const MeasuredContact& from = gathered.contact;
    all.push_back(
        {{EndOf(from.a, from.part_a), EndOf(from.b, from.part_b), from.p_W, from.normal_W, from.force_W},
         gathered.index,
         gathered.share});
  }
  // Sorts contacts of the same pair of parts, from all substeps, next to each other.
  std::ranges::stable_sort(all, {}, [&ends](const Found& one) {
    return std::tuple_cat(ends(one.contact), std::tuple(one.index));
  });
  std::vector<Contact> merged;
  for (std::size_t i = 0; i < all.size();) {
    Contact contact = all[i].contact;
    double share = all[i].share;
    std::size_t next = i + 1;
    for (; next < all.size() && all[next].index == all[i].index && ends(all[next].contact) == ends(contact);
         ++next) {
      contact.force_W += all[next].contact.force_W;
      contact.p_W = all[next].contact.p_W;
      contact.normal_W = all[next].contact.normal_W;
      share += all[next].share;
    }
    // The body slept mid-step: average over the moving part.
    if (Sleeps(contact.a, bodies) && Sleeps(contact.b, bodies)) contact.force_W /= share;
    merged.push_back(contact);
    i = next;
  }
  // New contacts replace old ones of the same parts.
  std::erase_if(contacts_, [&](const Contact& old) {
    const auto at = std::ranges::lower_bound(merged, ends(old), {}, ends);
    return at != merged.end() && ends(*at) == ends(old);
  });
  contacts_.insert(contacts_.end(), merged.begin(), merged.end());
  std::ranges::stable_sort(contacts_, {}, ends);
  SortContactsByRobot();
}

// Otherwise each robot's wrenches would scan the contacts of all robots.
void Measures::SortContactsByRobot() {
  by_robot_.clear();
  for (std::uint32_t i = 0; i < contacts_.size(); ++i) {
    const std::int32_t a = contacts_[i].a.robot, b = contacts_[i].b.robot;
    if (a >= 0) by_robot_.push_back({a, i});
    if (b >= 0 && b != a) by_robot_.push_back({b, i});
  }
  std::ranges::sort(by_robot_);
}

void Measures::End(const Moment& moment, std::span<const BodyState> bodies,
                   std::span<const ChannelState> channels) {
  EndContacts(bodies);
  for (const Measured& of : robots_) {
    const SceneRobot& robot = scene_->robots[static_cast<std::size_t>(of.robot)];
    const auto now = bodies.subspan(static_cast<std::size_t>(robot.first_body),
                                    static_cast<std::size_t>(robot.body_count));
    const auto own = channels.subspan(static_cast<std::size_t>(robot.first_channel),
                                      static_cast<std::size_t>(robot.channel_count));
    for (const Sensor& sensor : of.sensors) {
      const std::span values = std::span(values_).subspan(sensor.first, MeasuredCount(*sensor.kind));
      const auto measure = [&]<typename Kind>(const Kind& kind) {
        if constexpr (std::is_same_v<Kind, ImuModel> || std::is_same_v<Kind, WrenchModel>) {
          if (now.front().frozen()) {
            std::ranges::fill(values, 0.0);
          } else {
            Measure(kind, of, now, moment, values);
          }
        } else if constexpr (std::is_same_v<Kind, BatteryModel>) {
          Measure(kind, of, now, own, moment, values);
        } else if constexpr (std::is_same_v<Kind, OdometryModel>) {
          Measure(kind, of, sensor.number, own, moment, values);
        } else if constexpr (std::is_same_v<Kind, ChannelModel>) {
          Measure(kind, of, values);
        }
      };
      std::visit(measure, *sensor.kind);
    }
  }
}

Pose Measures::PlaceInBody(const Measured& of, int link) const {
  const SceneRobot& robot = scene_->robots[static_cast<std::size_t>(of.robot)];
  const LinkModel& model = robot.entry.model->links[static_cast<std::size_t>(link)];
  return robot.one_body() ? robot.X_BR * model.X_RL : model.X_LI.Inverse();
}

// The mean acceleration of the step, along the sensor's axes at mid-step: a sensor on a turntable then reads
// ω²r along its radius.
void Measures::Measure(const ImuModel& model, const Measured& of, std::span<const BodyState> now,
                       const Moment& moment, std::span<double> values) const {
  const SceneRobot& robot = scene_->robots[static_cast<std::size_t>(of.robot)];
  const std::size_t index = BodyOf(robot, model.mount.link);
  const BodyState &was = of.before[index], &is = now[index];
  const Pose X_BS = PlaceInBody(of, model.mount.link) * model.mount.X_LS;
  const auto velocity = [&X_BS](const BodyState& body) -> Vector3 {
    return body.v_WB + body.w_WB.cross(body.orientation() * X_BS.p);
  };
  const Vector3 a_W = (velocity(is) - velocity(was)) / moment.dt_s;
  const Quaternion q_WS = TurnBack(is, moment.dt_s / 2) * is.orientation() * X_BS.q;
  Write(q_WS.conjugate() * a_W, values);
}

Measures::Motion Measures::MotionOf(const Measured& of, std::span<const BodyState> now, int link,
                                    double mass_kg, const Pose& X_LI, const Vector3& inertia_kg_m2) const {
  const SceneRobot& robot = scene_->robots[static_cast<std::size_t>(of.robot)];
  const std::size_t index = BodyOf(robot, link);
  const BodyState &was = of.before[index], &is = now[index];
  const Pose X_BI = PlaceInBody(of, link) * X_LI;
  const auto velocity = [&](const BodyState& body) -> Vector3 {
    return body.v_WB + body.w_WB.cross(body.orientation() * X_BI.p);
  };
  const auto momentum = [&](const BodyState& body) -> Vector3 {
    const Quaternion q_WI = body.orientation() * X_BI.q;
    return q_WI * Vector3(inertia_kg_m2.cwiseProduct(q_WI.conjugate() * body.w_WB));
  };
  const auto place = [&X_BI](const BodyState& body) -> Vector3 {
    return body.p_WB + body.orientation() * X_BI.p;
  };
  return {place(was),
          (place(was) + place(is)) / 2,
          mass_kg * velocity(was),
          mass_kg * velocity(is),
          momentum(was),
          momentum(is)};
}

// Newton's and Euler's laws for everything beyond the joint: the wrench through the joint is the rate of
// change of momentum less the wrenches of weight and contacts.
void Measures::Measure(const WrenchModel& model, const Measured& of, std::span<const BodyState> now,
                       const Moment& moment, std::span<double> values) const {
  const SceneRobot& robot = scene_->robots[static_cast<std::size_t>(of.robot)];
  const RobotModel& of_robot = *robot.entry.model;
  const std::size_t index = BodyOf(robot, model.mount.link);
  const BodyState &was = of.before[index], &is = now[index];
  const Pose X_BS = PlaceInBody(of, model.mount.link) * model.mount.X_LS;
  // Weight and contacts act at the positions of the step's beginning; in flight, weight acts at those of
  // mid-step, where the momentum changes.
  const Vector3 o_W = was.p_WB + was.orientation() * X_BS.p;
  const Vector3 middle_W = (o_W + is.p_WB + is.orientation() * X_BS.p) / 2;
  const double flight = flight_[of.thing];
  Vector3 force = Vector3::Zero(), torque = Vector3::Zero();
  const auto add = [&](const Motion& motion, double mass_kg) {
    const Vector3 gained = (motion.P_next_W - motion.P_W) / moment.dt_s;
    const Vector3 carried = Vector3::Zero() - mass_kg * scene_->scenario->simulation.g_W;
    force += gained + carried;
    const Vector3 arm = motion.p_W - o_W, middle_arm = motion.middle_W - middle_W;
    torque += middle_arm.cross(gained) + (arm + flight * (middle_arm - arm)).cross(carried) +
              (motion.L_next_W - motion.L_W) / moment.dt_s;
  };
  const WrenchModel::Part& part = model.part;
  add(MotionOf(of, now, part.link, part.mass_kg, part.X_LI, part.inertia_kg_m2), part.mass_kg);
  for (const int link : model.beyond) {
    const LinkModel& beyond = of_robot.links[static_cast<std::size_t>(link)];
    add(MotionOf(of, now, link, beyond.mass_kg, beyond.X_LI, beyond.inertia_kg_m2), beyond.mass_kg);
  }
  const auto is_beyond = [&](const ContactEnd& end) {
    if (end.robot != of.robot) return false;
    if (std::ranges::find(model.beyond, end.link) != model.beyond.end()) return true;
    return end.link == part.link &&
           std::ranges::find(part.collisions, static_cast<std::size_t>(end.collision)) !=
               part.collisions.end();
  };
  for (const ContactOfRobot& one :
       std::ranges::equal_range(by_robot_, of.robot, {}, &ContactOfRobot::robot)) {
    const Contact& contact = contacts_[one.contact];
    for (const auto& [end, sign] : {std::pair(contact.a, 1.0), std::pair(contact.b, -1.0)}) {
      if (!is_beyond(end)) continue;
      force -= sign * contact.force_W;
      torque -= (contact.p_W - o_W).cross(sign * contact.force_W);
    }
  }
  const Quaternion q_WS = TurnBack(is, moment.dt_s / 2) * is.orientation() * X_BS.q;
  const double sign = model.on_parent ? -1 : 1;
  Write(sign * (q_WS.conjugate() * force), values.first(3));
  Write(sign * (q_WS.conjugate() * torque), values.subspan(3));
}

// Wheels of fidelity rolling and planar have no measured effort: the change of the robot's kinetic energy
// counts instead.
void Measures::Measure(const BatteryModel& model, const Measured& of, std::span<const BodyState> now,
                       std::span<const ChannelState> channels, const Moment& moment,
                       std::span<double> values) const {
  const SceneRobot& robot = scene_->robots[static_cast<std::size_t>(of.robot)];
  const auto work_j =
      std::span(work_j_).subspan(static_cast<std::size_t>(robot.first_channel), channels.size());
  double motors_j = std::accumulate(work_j.begin(), work_j.end(), 0.0);
  const auto is_unmeasured = [](const ChannelState& channel) { return std::isnan(channel.effort); };
  if (robot.one_body() && std::ranges::any_of(channels, is_unmeasured)) {
    const RigidBody& body = things_->all[of.thing].mechanism->bodies.front();
    const auto energy_j = [&body](const BodyState& state) {
      const Vector3 w_B = state.orientation().conjugate() * state.w_WB;
      return (body.mass_kg * state.v_WB.squaredNorm() + w_B.dot(body.inertia_kg_m2 * w_B)) / 2;
    };
    motors_j += std::abs(energy_j(now.front()) - energy_j(of.before.front()));
  }
  const double power_w = model.idle_w + motors_j / moment.dt_s / model.efficiency;
  values[0] = std::max(0.0, values[0] - power_w * moment.dt_s);
  values[1] = power_w;
}

void Measures::Measure(const ChannelModel& model, const Measured& of, std::span<double> values) const {
  const auto first =
      static_cast<std::size_t>(scene_->robots[static_cast<std::size_t>(of.robot)].first_channel);
  for (const ChannelModel::Value& value : model.values) {
    if (value.sums_work) values[value.first_cell] += work_j_[first + value.channel];
  }
}

// Moves along the exact arc of both wheels' travel.
void Measures::Measure(const OdometryModel& model, const Measured& of, std::uint32_t number,
                       std::span<const ChannelState> channels, const Moment& moment,
                       std::span<double> values) const {
  const SceneRobot& robot = scene_->robots[static_cast<std::size_t>(of.robot)];
  const ActuatorModel* actuator = robot.entry.model->drive_actuator();
  if (actuator == nullptr) return;
  const auto& drive = std::get<DriveModel>(actuator->kind);
  const std::size_t first = robot.entry.model->FirstChannel(*actuator);
  double way_m[2];
  for (std::size_t side = 0; side < 2; ++side) {
    double counted_rad = channels[first + side].position;
    if (model.resolution_rad > 0)
      counted_rad = std::floor(counted_rad / model.resolution_rad) * model.resolution_rad;
    way_m[side] = drive.wheel_radius_m * (counted_rad - values[5 + side]);
    values[5 + side] = counted_rad;
    if (model.slip_stddev <= 0) continue;
    way_m[side] *=
        1 + model.slip_stddev * GaussianNoise({moment.seed, NoiseKind::kSlip, robot.id.value, number,
                                               moment.step, static_cast<std::uint32_t>(side)});
  }
  const double forward_m = (way_m[0] + way_m[1]) / 2, turn_rad = (way_m[1] - way_m[0]) / drive.track_m;
  const double half_rad = turn_rad / 2;
  const double chord_m =
      std::abs(half_rad) > 1e-9 ? forward_m * portable::Sin(half_rad) / half_rad : forward_m;
  const auto [sine, cosine] = portable::SinCos(values[2] + half_rad);
  values[0] += chord_m * cosine;
  values[1] += chord_m * sine;
  values[2] += turn_rad;
  values[3] = forward_m / moment.dt_s;
  values[4] = turn_rad / moment.dt_s;
}

}  // namespace coopdyn
