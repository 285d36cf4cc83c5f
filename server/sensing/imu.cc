// SPDX-License-Identifier: MIT
// Inertial measurement units: turn rates, acceleration and orientation, with noise.
#include "server/base/portable_math.h"
#include "server/sensing/readings.h"
#include "server/state/noise.h"

namespace coopdyn {

Pose MountPose(const Frame& frame, int robot, const Mount& mount) {
  return LinkPose(frame, robot, mount.link) * mount.X_LS;
}

Vector3 LinkTurn(const Frame& frame, int robot, int link) {
  const SceneRobot& of = frame.scene->robots[static_cast<std::size_t>(robot)];
  const int body = of.first_body + (of.one_body() ? 0 : link);
  return frame.bodies[static_cast<std::size_t>(body)].w_WB;
}

std::optional<ImuReading> Imu(const Frame& frame, int robot, std::size_t number) {
  const RobotModel& robot_model = ModelOf(frame, robot);
  const auto* model = robot_model.Find<ImuModel>(number);
  if (model == nullptr) return std::nullopt;
  const Pose X_WS = MountPose(frame, robot, model->mount);
  const std::span<const double> measured = MeasuredOf(frame, robot, robot_model.IndexOf<ImuModel>(number));
  const Vector3 up_W = Vector3::Zero() - frame.scene->scenario->simulation.g_W;
  ImuReading reading;
  reading.q_WS = X_WS.q;
  reading.turn_S = X_WS.q.conjugate() * LinkTurn(frame, robot, model->mount.link);
  reading.acceleration_S = X_WS.q.conjugate() * up_W;
  if (!measured.empty()) reading.acceleration_S += Vector3(measured[0], measured[1], measured[2]);

  NoiseKey key{frame.seed,
               NoiseKind::kImuTurn,
               frame.scene->robots[static_cast<std::size_t>(robot)].id.value,
               static_cast<std::uint32_t>(number + 1),
               frame.step,
               0};
  Vector3 lean_S = Vector3::Zero();
  for (std::uint32_t axis = 0; axis < 3; ++axis) {
    key.sample = axis;
    key.kind = NoiseKind::kImuTurn;
    reading.turn_S[axis] = Noisy(reading.turn_S[axis], model->turn_noise[axis], key);
    key.kind = NoiseKind::kImuAcceleration;
    reading.acceleration_S[axis] = Noisy(reading.acceleration_S[axis], model->acceleration_noise[axis], key);
    key.kind = NoiseKind::kImuOrientation;
    if (model->orientation_noise_stddev_rad > 0)
      lean_S[axis] = model->orientation_noise_stddev_rad * GaussianNoise(key);
  }
  if (const double angle_rad = lean_S.norm(); angle_rad > 0)
    reading.q_WS = reading.q_WS * portable::AngleAxis(angle_rad, lean_S / angle_rad);
  return reading;
}

}  // namespace coopdyn
