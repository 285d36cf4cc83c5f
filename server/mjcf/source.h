// SPDX-License-Identifier: MIT
// A compiled MJCF model and what its parts are called in SDF. One thread.
#pragma once

#include <mujoco/mujoco.h>

#include <map>
#include <string>
#include <vector>

#include "server/geometry/shape.h"
#include "server/mjcf/load.h"
#include "server/mjcf/words.h"

namespace coopdyn::mjcf {

inline Vector3 ToVector(const mjtNum* v) {
  return {v[0], v[1], v[2]};
}
/// MuJoCo writes w first.
inline Pose ToPose(const mjtNum* p, const mjtNum* q) {
  return {ToVector(p), Quaternion(q[0], q[1], q[2], q[3]).normalized()};
}

/// `name` without what SDF or a list of names does not take.
std::string PlainName(std::string name);

class Source {
 public:
  Source(const Loaded& loaded, Words& words);

  const mjModel& model() const { return model_; }
  const Loaded& loaded() const { return loaded_; }
  Words& words() const { return words_; }

  /// Of the object `id`, as SDF can have it; `otherwise`_ID if it has no name.
  std::string NameOf(mjtObj type, int id, const std::string& otherwise) const;
  std::string BodyName(int body) const { return body == 0 ? "world" : NameOf(mjOBJ_BODY, body, "body"); }
  std::string JointName(int joint) const { return NameOf(mjOBJ_JOINT, joint, "joint"); }

  /// Whether the geom's masks let it touch what is not of its own tree: the floor, if the file has none, too.
  bool Collides(int geom) const { return collides_[static_cast<std::size_t>(geom)] != 0; }
  /// Of the floor in the file: its highest level plane. Below X_WB() and in what is written it lies at 0.
  double floor_z_m() const { return floor_z_m_; }
  /// In the pose in which the model is written.
  const Pose& X_WB(int body) const { return X_WB_[static_cast<std::size_t>(body)]; }
  /// The greatest force or torque that actuators give the joint; 0: it has none.
  double Effort(int joint) const { return efforts_[static_cast<std::size_t>(joint)]; }
  /// The greatest speed, of velocity servos; 0: nothing is said.
  double Speed(int joint) const { return speeds_[static_cast<std::size_t>(joint)]; }
  /// How far from the pose in which the model is written the joint starts: by the keyframe `home`.
  double Start(int joint) const;
  int home() const { return home_; }  // -1: there is none

 private:
  void ReadActuators();
  void ReadMasks();
  void FindFloor();

  const Loaded& loaded_;
  const mjModel& model_;
  Words& words_;
  int home_;
  std::vector<Pose> X_WB_;
  std::vector<char> collides_;  // by geom
  double floor_z_m_ = 0;
  std::vector<double> efforts_, speeds_;
};

/// The greatest force of actuator `index` on its transmission, before its gear; 0 if nothing limits it.
double ForceLimit(const mjModel& model, int index);
bool IsMuscle(const mjModel& model, int index);

}  // namespace coopdyn::mjcf
