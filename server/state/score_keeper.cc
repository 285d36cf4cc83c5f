// SPDX-License-Identifier: MIT
#include "server/state/score_keeper.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "server/base/portable_math.h"
#include "server/model/values.h"
#include "server/state/world_change.h"

namespace coopdyn {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

bool IsRobot(std::int32_t id) {
  return id >= WorldId::kRobots;
}

/// `part`: among the link frames of the robot's file; -1: the robot, or the thing, as a whole.
Pose PoseOf(const Frame& frame, std::int32_t id, int index, int part = -1) {
  const auto at = static_cast<std::size_t>(index);
  if (!IsRobot(id)) return ObjectPose(frame, frame.scene->objects[at]);
  if (part < 0) return RobotPose(frame, index);
  const RobotModel& model = *frame.scene->robots[at].entry.model;
  const FrameModel& of = model.frames[static_cast<std::size_t>(part)];
  const Pose& X_RL = model.links[static_cast<std::size_t>(of.link)].X_RL;
  return LinkPose(frame, index, of.link) * X_RL.Inverse() * of.X_RF;
}

/// The link frame of `robot` that the entry's `of` names as ROBOT/LINK; -1 if none.
int PartOf(const ScoreEntry& entry, const RobotEntry& robot) {
  for (const std::string& one : entry.of) {
    for (std::size_t i = 0; i < robot.model->frames.size(); ++i) {
      if (ToLower(one) == ToLower(robot.name + "/" + robot.model->frames[i].name)) return static_cast<int>(i);
    }
  }
  return -1;
}

/// The position of the target, thing or lamp `name`; nullopt if it has been removed.
std::optional<Vector3> PlaceOf(const Frame& frame, const std::string& name) {
  const std::string word = ToLower(name);
  for (const Target& target : frame.scene->targets) {
    if (ToLower(target.color_name) == word || TargetName(target) == word) return target.p_WT;
  }
  for (const SceneObject& object : frame.scene->objects) {
    if (ToLower(object.object.name) == word) return ObjectPose(frame, object).p;
  }
  for (const PointLight& light : frame.scene->lights) {
    if (ToLower(light.name) == word) return light.p_WP;
  }
  return std::nullopt;
}

/// Distance from `p_W` to the surface of `shape` at `X_WO`; 0 inside.
double DistanceTo(const Shape& shape, const Pose& X_WO, const Vector3& p_W) {
  const Vector3 p = X_WO.q.conjugate() * (p_W - X_WO.p);
  if (const auto* box = std::get_if<Box>(&shape)) {
    return (p.cwiseAbs() - box->size_m / 2).cwiseMax(0).norm();
  }
  if (const auto* cylinder = std::get_if<Cylinder>(&shape)) {
    return portable::Hypot(std::max(0.0, portable::Hypot(p.x(), p.y()) - cylinder->radius_m),
                           std::max(0.0, std::abs(p.z()) - cylinder->length_m / 2));
  }
  if (const auto* sphere = std::get_if<Sphere>(&shape)) return std::max(0.0, p.norm() - sphere->radius_m);
  return kInfinity;  // a world's things have no other shapes
}

/// A robot as an upright cylinder, or a thing as a point.
struct Body {
  std::int32_t id = 0;
  Vector3 p_W = Vector3::Zero();  // centre
  double radius_m = 0;
};

Body BodyOf(const Frame& frame, std::int32_t id, int index) {
  const Pose X = PoseOf(frame, id, index);
  if (!IsRobot(id)) return {id, X.p, 0};
  const RobotModel& model = *frame.scene->robots[static_cast<std::size_t>(index)].entry.model;
  return {id, X * Vector3(0, 0, model.height_m / 2), model.footprint_radius_m};
}

std::int32_t RobotIdOf(const SceneRobot& robot) {
  return WorldId::kRobots + static_cast<std::int32_t>(robot.id.value);
}

/// The least distance between a subject and anything else; between robots seen from above.
double NearestOf(const Frame& frame, std::span<const Body> subjects) {
  const Scene& scene = *frame.scene;
  double nearest = kInfinity;
  for (const SceneObject& object : scene.objects) {
    const Pose X_WO = ObjectPose(frame, object);
    for (const Body& body : subjects) {
      if (body.id == static_cast<std::int32_t>(object.id.value)) continue;
      nearest =
          std::min(nearest, std::max(0.0, DistanceTo(object.object.shape, X_WO, body.p_W) - body.radius_m));
    }
  }
  // Sorted by x: only neighbours are compared.
  std::vector<Body> robots;
  double largest_m = 0;
  for (std::size_t i = 0; i < scene.robots.size(); ++i) {
    robots.push_back(BodyOf(frame, RobotIdOf(scene.robots[i]), static_cast<int>(i)));
    largest_m = std::max(largest_m, robots.back().radius_m);
  }
  std::ranges::sort(robots, {}, [](const Body& one) { return one.p_W.x(); });
  for (const Body& body : subjects) {
    const auto at =
        std::ranges::lower_bound(robots, body.p_W.x(), {}, [](const Body& one) { return one.p_W.x(); });
    const auto look = [&](const Body& other) {
      const double dx = std::abs(other.p_W.x() - body.p_W.x());
      if (dx - body.radius_m - largest_m >= nearest) return false;
      if (other.id == body.id) return true;
      const double apart = portable::Hypot(dx, other.p_W.y() - body.p_W.y()) - body.radius_m - other.radius_m;
      nearest = std::min(nearest, std::max(0.0, apart));
      return true;
    };
    for (auto up = at; up != robots.end() && look(*up); ++up) continue;
    for (auto down = at; down != robots.begin() && look(*std::prev(down)); --down) continue;
  }
  return nearest;
}

/// Work of robot `index`'s motors in the step before `frame`, J.
double WorkOf(const Frame& frame, int index) {
  double power = 0;
  for (const ChannelState& channel : ChannelsOf(frame, index)) {
    const double watts = std::abs(channel.effort * channel.velocity);
    if (std::isfinite(watts)) power += watts;
  }
  return power * ToSeconds(frame.step_length);
}

std::int32_t IdOf(const ContactEnd& end, const Scene& scene) {
  if (end.robot >= 0) return RobotIdOf(scene.robots[static_cast<std::size_t>(end.robot)]);
  return end.object < 0
             ? 0
             : static_cast<std::int32_t>(scene.objects[static_cast<std::size_t>(end.object)].id.value);
}

}  // namespace

std::vector<ScoreKeeper::Subject> ScoreKeeper::SubjectsOf(const ScoreEntry& entry, const Scene& scene) const {
  const auto is_meant = [&](const std::string& name) {
    const std::string word = ToLower(name);
    return std::ranges::any_of(entry.of, [&](const std::string& one) {
      if (ToLower(one) == word) return true;
      const auto swarm = std::ranges::find_if(scene.scenario->swarms, [&](const SwarmEntry& of) {
        return ToLower(of.name) == ToLower(one) || of.section == ToLower(one);
      });
      if (swarm == scene.scenario->swarms.end()) return false;
      const std::string prefix = ToLower(swarm->name) + "_";
      return word.starts_with(prefix) &&
             word.find_first_not_of("0123456789", prefix.size()) == std::string::npos;
    });
  };
  std::vector<Subject> subjects;
  for (std::size_t i = 0; i < scene.objects.size() && !entry.of.empty(); ++i) {
    if (is_meant(scene.objects[i].object.name))
      subjects.push_back({static_cast<std::int32_t>(scene.objects[i].id.value), static_cast<int>(i)});
  }
  for (std::size_t i = 0; i < scene.robots.size(); ++i) {
    const int part = PartOf(entry, scene.robots[i].entry);
    if (entry.of.empty() || part >= 0 || is_meant(scene.robots[i].entry.name))
      subjects.push_back({RobotIdOf(scene.robots[i]), static_cast<int>(i), part});
  }
  std::ranges::sort(subjects, {}, &Subject::id);
  return subjects;
}

void ScoreKeeper::Use(const Frame& frame) {
  if (scene_ == frame.scene) return;
  scene_ = frame.scene;
  for (Book& book : books_) {
    std::vector<Subject> now = SubjectsOf(book.entry, *scene_);
    for (Subject& subject : now) {
      const auto before = std::ranges::lower_bound(book.subjects, subject.id, {}, &Subject::id);
      if (before != book.subjects.end() && before->id == subject.id) {
        const int index = subject.index;
        subject = *before;
        subject.index = index;
        continue;
      }
      const Vector3 p = PoseOf(frame, subject.id, subject.index, subject.part).p;
      subject.x = p.x();
      subject.y = p.y();
    }
    book.subjects = std::move(now);
  }
}

void ScoreKeeper::Begin(Frame& frame) {
  books_.clear();
  scene_ = nullptr;
  for (const ScoreEntry& entry : frame.scene->scenario->scores) {
    Book book;
    book.entry = entry;
    book.sum = entry.kind == ScoreKind::kNearest ? kInfinity : 0;
    books_.push_back(std::move(book));
  }
  Use(frame);
  for (Book& book : books_) Look(book, frame, false);
  Fill(frame);
}

void ScoreKeeper::AddTo(Frame& frame) {
  if (books_.empty()) return;
  Use(frame);
  for (Book& book : books_) Look(book, frame, true);
  Fill(frame);
}

void ScoreKeeper::Refit(Frame& now) {
  if (books_.empty()) return;
  Use(now);
  Fill(now);
}

void ScoreKeeper::Look(Book& book, const Frame& frame, bool follows) {
  const ScoreEntry& entry = book.entry;
  switch (entry.kind) {
    case ScoreKind::kReach: {
      const std::optional<Vector3> p_WT = PlaceOf(frame, entry.target);
      for (Subject& subject : book.subjects) {
        if (!p_WT || subject.marked) continue;
        const Vector3 p = PoseOf(frame, subject.id, subject.index, subject.part).p;
        subject.marked = portable::Hypot(p.x() - p_WT->x(), p.y() - p_WT->y()) <= entry.within_m;
      }
      break;
    }
    case ScoreKind::kDistance:
      for (Subject& subject : book.subjects) {
        const Vector3 p = PoseOf(frame, subject.id, subject.index, subject.part).p;
        if (follows) book.sum += portable::Hypot(p.x() - subject.x, p.y() - subject.y);
        subject.x = p.x();
        subject.y = p.y();
      }
      break;
    case ScoreKind::kCollisions: {
      std::set<std::pair<std::int32_t, std::int32_t>> touching;
      for (const Contact& contact : frame.contacts) {
        const std::int32_t a = IdOf(contact.a, *scene_), b = IdOf(contact.b, *scene_);
        if (a == 0 || b == 0 || a == b) continue;
        const auto is_ours = [&book](std::int32_t id) {
          return std::ranges::binary_search(book.subjects, id, {}, &Subject::id);
        };
        if (is_ours(a) || is_ours(b)) touching.emplace(std::min(a, b), std::max(a, b));
      }
      for (const auto& pair : touching) book.sum += book.pairs.contains(pair) ? 0 : 1;
      book.pairs = std::move(touching);
      break;
    }
    case ScoreKind::kNearest: {
      std::vector<Body> bodies;
      for (const Subject& subject : book.subjects) bodies.push_back(BodyOf(frame, subject.id, subject.index));
      book.sum = std::min(book.sum, NearestOf(frame, bodies));
      break;
    }
    case ScoreKind::kEnergy:
      for (const Subject& subject : book.subjects) {
        if (follows && IsRobot(subject.id)) book.sum += WorkOf(frame, subject.index);
      }
      break;
    case ScoreKind::kUpright:
      for (Subject& subject : book.subjects) {
        const Vector3 up = PoseOf(frame, subject.id, subject.index, subject.part).q * Vector3::UnitZ();
        subject.marked |= portable::Acos(std::clamp(up.z(), -1.0, 1.0)) > entry.tilt_rad;
      }
      break;
    case ScoreKind::kCoverage:
      for (const Subject& subject : book.subjects) {
        const Vector3 p = PoseOf(frame, subject.id, subject.index, subject.part).p;
        if (!p.allFinite() || !scene_->floor.IsUnder(p.x(), p.y())) continue;
        book.pairs.emplace(static_cast<std::int32_t>(std::floor(p.x() / entry.cell_m)),
                           static_cast<std::int32_t>(std::floor(p.y() / entry.cell_m)));
      }
      break;
    default:
      break;
  }
}

double ScoreKeeper::ValueOf(const Book& book, const Frame& frame) const {
  const auto count = static_cast<double>(book.subjects.size());
  const auto marked = static_cast<double>(std::ranges::count_if(book.subjects, &Subject::marked));
  const auto at = [&frame](const Subject& subject) {
    return PoseOf(frame, subject.id, subject.index, subject.part).p;
  };
  switch (book.entry.kind) {
    case ScoreKind::kReach:
      return marked;
    case ScoreKind::kTime:
      return frame.time_s();
    case ScoreKind::kDistance:
      return count > 0 ? book.sum / count : kNoScore;
    case ScoreKind::kTravelled: {
      double sum = 0;
      for (const Subject& subject : book.subjects) sum += at(subject).x() - subject.x;
      return count > 0 ? sum / count : kNoScore;
    }
    case ScoreKind::kNearest:
      return std::isfinite(book.sum) ? book.sum : kNoScore;
    case ScoreKind::kUpright:
      return count - marked;
    case ScoreKind::kFormation: {
      double sum = 0;
      for (std::size_t i = 0; i < book.subjects.size(); ++i) {
        for (std::size_t j = i + 1; j < book.subjects.size(); ++j) {
          const Subject &a = book.subjects[i], &b = book.subjects[j];
          const Vector3 apart = at(a) - at(b);
          const double error = portable::Hypot(apart.x(), apart.y()) - portable::Hypot(a.x - b.x, a.y - b.y);
          sum += error * error;
        }
      }
      return count > 1 ? std::sqrt(sum / (count * (count - 1) / 2)) : kNoScore;
    }
    case ScoreKind::kCoverage:
      return static_cast<double>(book.pairs.size()) * book.entry.cell_m * book.entry.cell_m;
    default:
      return book.sum;
  }
}

void ScoreKeeper::Fill(Frame& frame) const {
  frame.scores.clear();
  for (const Book& book : books_) {
    Score score{ValueOf(book, frame), false};
    if (const std::optional<ScoreUntil>& until = book.entry.until) {
      ScoreUntil asked = *until;
      if (asked.all) asked.value = static_cast<double>(book.subjects.size());
      // A condition that already holds at the start does not end the run.
      score.met = frame.step > 0 && asked.Holds(score.value);
    }
    frame.scores.push_back(score);
  }
}

std::vector<double> ScoreKeeper::Save() const {
  std::vector<double> saved;
  for (const Book& book : books_) {
    saved.push_back(book.sum);
    saved.push_back(static_cast<double>(book.subjects.size()));
    for (const Subject& one : book.subjects) {
      saved.insert(saved.end(), {static_cast<double>(one.id), one.marked ? 1.0 : 0.0, one.x, one.y});
    }
    saved.push_back(static_cast<double>(book.pairs.size()));
    for (const auto& [a, b] : book.pairs)
      saved.insert(saved.end(), {static_cast<double>(a), static_cast<double>(b)});
  }
  return saved;
}

bool ScoreKeeper::Restore(Frame& frame, std::span<const double> saved) {
  Begin(frame);
  std::vector<Book> books = books_;
  std::size_t next = 0;
  const auto take = [&] { return next < saved.size() ? saved[next++] : kNoScore; };
  const auto take_count = [&](std::size_t width) {
    const double count = take();
    const std::size_t room = (saved.size() - next) / width;
    const bool fits = count >= 0 && count <= static_cast<double>(room);
    return fits ? static_cast<std::size_t>(count) : std::numeric_limits<std::size_t>::max();
  };
  constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();
  for (Book& book : books) {
    book.sum = take();
    const std::size_t subjects = take_count(4);
    if (subjects == kNone) return false;
    for (std::size_t i = 0; i < subjects; ++i) {
      const double id = take(), marked = take(), x = take(), y = take();
      const auto found =
          std::ranges::find_if(book.subjects, [id](const Subject& one) { return one.id == id; });
      if (found == book.subjects.end()) continue;
      found->marked = marked != 0;
      found->x = x;
      found->y = y;
    }
    const std::size_t pairs = take_count(2);
    if (pairs == kNone) return false;
    book.pairs.clear();
    for (std::size_t i = 0; i < pairs; ++i) {
      const double a = take(), b = take();
      constexpr double kMost = std::numeric_limits<std::int32_t>::max();
      if (!(std::abs(a) <= kMost && std::abs(b) <= kMost)) return false;
      book.pairs.emplace(static_cast<std::int32_t>(a), static_cast<std::int32_t>(b));
    }
  }
  if (next != saved.size()) return false;
  books_ = std::move(books);
  Fill(frame);
  return true;
}

int EndingScore(const Frame& frame) {
  const std::vector<ScoreEntry>& entries = frame.scene->scenario->scores;
  for (std::size_t i = 0; i < frame.scores.size() && i < entries.size(); ++i) {
    const bool late = entries[i].limit_s && frame.step > 0 && frame.time_s() >= *entries[i].limit_s;
    if (frame.scores[i].met || late) return static_cast<int>(i);
  }
  return -1;
}

}  // namespace coopdyn
