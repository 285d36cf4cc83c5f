// SPDX-License-Identifier: MIT
// A compiled MJCF model and the SDF names of its parts. One thread.
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
/// MuJoCo stores w first.
inline Pose ToPose(const mjtNum* p, const mjtNum* q) {
  return {ToVector(p), Quaternion(q[0], q[1], q[2], q[3]).normalized()};
}

/// `name` with `_` for each character that SDF names or lists of names cannot contain.
std::string PlainName(std::string name);

class Source {
 public:
  Source(const Loaded& loaded, Words& words);

  const mjModel& model() const { return model_; }
  const Loaded& loaded() const { return loaded_; }
  Words& words() const { return words_; }

  /// The name of object `id`, valid in SDF; `otherwise`_ID if it has none.
  std::string NameOf(mjtObj type, int id, const std::string& otherwise) const;
  std::string BodyName(int body) const { return body == 0 ? "world" : NameOf(mjOBJ_BODY, body, "body"); }
  std::string JointName(int joint) const { return NameOf(mjOBJ_JOINT, joint, "joint"); }

  /// True if the geom's masks let it collide with another tree, or with coopdyn's floor if the file has no
  /// plane.
  bool Collides(int geom) const { return collides_[static_cast<std::size_t>(geom)] != 0; }
  /// Height of the file's floor, which is its highest horizontal plane. In X_WB() and in the written SDF the
  /// floor is at 0.
  double floor_z_m() const { return floor_z_m_; }
  /// Pose of the body when the model is in the pose in which it is written.
  const Pose& X_WB(int body) const { return X_WB_[static_cast<std::size_t>(body)]; }
  /// The maximum force or torque of the joint's actuators; 0 without actuators.
  double Effort(int joint) const { return efforts_[static_cast<std::size_t>(joint)]; }
  /// The maximum speed of the joint's velocity servo; 0 if unknown.
  double Speed(int joint) const { return speeds_[static_cast<std::size_t>(joint)]; }
  /// The joint's position in keyframe `home`, from the pose in which the model is written; 0 without it.
  double Start(int joint) const;
  int home() const { return home_; }  // index of keyframe `home`; -1 if none

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

/// The maximum force of actuator `index` on its transmission, before its gear; 0 if unlimited.
double ForceLimit(const mjModel& model, int index);
bool IsMuscle(const mjModel& model, int index);

}  // namespace coopdyn::mjcf
